"""An encoder of Unix compress, which no package at hand has; written after the format's description, checked against gzip's decoder."""

from __future__ import annotations


def compress(plain: bytes, bits: int = 16, clear_every: int | None = None) -> bytes:
    """Bytes of a ``.Z`` file in block mode; `clear_every` empties the table after so many codes."""
    out, width, group = bytearray(), 9, list[int]()

    def flush(*, pad: bool) -> None:
        nonlocal group
        n = 8 if pad else len(group)
        value = sum(code << (width * k) for k, code in enumerate(group))
        out.extend(value.to_bytes((n * width + 7) // 8, "little") if group else b"")
        group = []

    def emit(code: int) -> None:
        group.append(code)
        if len(group) == 8:
            flush(pad=True)

    table = {bytes([k]): k for k in range(256)}
    free, string, codes = 257, b"", 0
    for k in range(len(plain)):
        longer = string + plain[k : k + 1]
        if longer in table:
            string = longer
            continue
        emit(table[string])
        codes += 1
        # The decoder's table is one entry behind: it widens when its own next entry no longer fits.
        if width < bits and free > (1 << width) - 1:
            flush(pad=True)
            width += 1
        if free < 1 << bits:
            table[longer] = free
            free += 1
        string = plain[k : k + 1]
        if clear_every is not None and codes % clear_every == 0:
            emit(table[string])
            string = b""
            emit(256)
            flush(pad=True)
            width, free, table = 9, 257, {bytes([n]): n for n in range(256)}
    if string:
        emit(table[string])
    flush(pad=False)
    return b"\x1f\x9d" + bytes([0x80 | bits]) + bytes(out)
