//! Parity of Mode S: 24 bits of the polynomial that ICAO Annex 10, volume IV gives; standard.

const POLYNOMIAL: u32 = 0x00FF_F409;

const TABLE: [u32; 256] = {
    let mut table = [0; 256];
    let mut k = 0;
    while k < 256 {
        let (mut rest, mut bit) = ((k as u32) << 16, 0);
        while bit < 8 {
            rest = if rest & 0x0080_0000 == 0 { rest << 1 } else { rest << 1 ^ POLYNOMIAL };
            bit += 1;
        }
        table[k] = rest & 0x00FF_FFFF;
        k += 1;
    }
    table
};

/// What is left of a message: zero where the parity of an extended squitter is right.
pub(super) fn remainder(message: &[u8]) -> u32 {
    message.iter().fold(0, |rest, byte| {
        let out = (rest >> 16) as u8;
        ((rest << 8 | u32::from(*byte)) & 0x00FF_FFFF) ^ TABLE[usize::from(out)]
    })
}
