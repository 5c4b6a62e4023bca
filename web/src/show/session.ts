// A page and the server of this host: the token of the address buys a session, whose cookie stays.

export function post(path: string, body: object): Promise<Response> {
    return fetch(path, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body), cache: "no-store" });
}

/** The token stands behind the # of the address that the command printed; it leaves the address bar at once. */
export async function begin(): Promise<void> {
    const token = location.hash.slice(1);
    if (!/^[0-9a-f]{32}$/.test(token)) return;
    history.replaceState(null, "", location.pathname);
    await post("/session", { token });
}
