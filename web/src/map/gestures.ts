// Mouse, touch and keyboard on the map.

export interface Moves {
    zoom: (factor: number, px?: number, py?: number) => void;
    pan: (dx: number, dy: number) => void;
    pick: (px: number, py: number) => void;
    whole: () => void;
    toCursor: () => void;
}

const STEP_PX = 60;

export function gestures(surface: HTMLElement, moves: Moves): () => void {
    const down = new Map<number, { x: number; y: number }>();
    const end = new AbortController();
    const { signal } = end;
    const local = (e: MouseEvent): { x: number; y: number } => {
        const box = surface.getBoundingClientRect();
        return { x: e.clientX - box.left, y: e.clientY - box.top };
    };
    surface.addEventListener("pointerdown", (e) => {
        surface.focus({ preventScroll: true });
        surface.setPointerCapture(e.pointerId);
        down.set(e.pointerId, local(e));
        if (e.pointerType !== "mouse") moves.pick(local(e).x, local(e).y);
    }, { signal });
    surface.addEventListener("pointermove", (e) => {
        const now = local(e);
        const before = down.get(e.pointerId);
        if (before === undefined) {
            moves.pick(now.x, now.y);
            return;
        }
        const other = [...down].find(([id]) => id !== e.pointerId)?.[1];
        if (other === undefined) moves.pan(now.x - before.x, now.y - before.y);
        else moves.zoom(Math.hypot(now.x - other.x, now.y - other.y) / Math.max(1, Math.hypot(before.x - other.x, before.y - other.y)), (now.x + other.x) / 2, (now.y + other.y) / 2);
        down.set(e.pointerId, now);
    }, { signal });
    for (const name of ["pointerup", "pointercancel"] as const) surface.addEventListener(name, (e) => down.delete(e.pointerId), { signal });
    surface.addEventListener("wheel", (e) => {
        // The page keeps scrolling until the map is asked for: by focus or by Ctrl.
        if (!e.ctrlKey && !e.metaKey && document.activeElement !== surface) return;
        e.preventDefault();
        moves.zoom(2 ** (-e.deltaY / 240), local(e).x, local(e).y);
    }, { signal, passive: false });
    surface.addEventListener("dblclick", (e) => moves.zoom(e.shiftKey ? 0.25 : 4, local(e).x, local(e).y), { signal });
    surface.addEventListener("keydown", (e) => {
        const act: Record<string, () => void> = {
            ArrowLeft: () => moves.pan(STEP_PX, 0), ArrowRight: () => moves.pan(-STEP_PX, 0), ArrowUp: () => moves.pan(0, STEP_PX), ArrowDown: () => moves.pan(0, -STEP_PX),
            "+": () => moves.zoom(2), "=": () => moves.zoom(2), "-": () => moves.zoom(0.5), "0": moves.whole, c: moves.toCursor,
        };
        const move = act[e.key];
        if (move === undefined || e.ctrlKey || e.metaKey || e.altKey) return;
        e.preventDefault();
        move();
    }, { signal });
    return () => end.abort();
}
