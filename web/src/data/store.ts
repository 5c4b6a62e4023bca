// A value that components share; what one of them sets, the others hear.

export class Store<T> {
    private readonly listeners = new Set<(value: T) => void>();
    private current: T;

    constructor(initial: T) {
        this.current = initial;
    }

    get(): T {
        return this.current;
    }

    set(value: T): void {
        if (value === this.current) return;
        this.current = value;
        for (const listener of [...this.listeners]) listener(value);
    }

    /** Calls back now and at every change; returns what ends that. */
    watch(listener: (value: T) => void): () => void {
        this.listeners.add(listener);
        listener(this.current);
        return () => this.listeners.delete(listener);
    }
}
