//! Checksums of SBF and NovAtel.

/// CRC-16 of the CCITT, polynomial 0x1021, beginning with zero.
pub(crate) fn crc16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0, |crc, byte| crc << 8 ^ TABLE[usize::from((crc >> 8) as u8 ^ byte)])
}

const TABLE: [u16; 256] = {
    let mut table = [0; 256];
    let mut k = 0;
    while k < 256 {
        let (mut crc, mut bit) = ((k as u16) << 8, 0);
        while bit < 8 {
            crc = if crc & 0x8000 == 0 { crc << 1 } else { crc << 1 ^ 0x1021 };
            bit += 1;
        }
        table[k] = crc;
        k += 1;
    }
    table
};

/// CRC-32 of NovAtel: the common polynomial, reflected, beginning with zero and not inverted.
pub(crate) fn crc32(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0, |crc, byte| crc >> 8 ^ TABLE_32[usize::from(crc as u8 ^ byte)])
}

const TABLE_32: [u32; 256] = {
    let mut table = [0; 256];
    let mut k = 0;
    while k < 256 {
        let (mut crc, mut bit) = (k as u32, 0);
        while bit < 8 {
            crc = if crc & 1 == 0 { crc >> 1 } else { crc >> 1 ^ 0xEDB8_8320 };
            bit += 1;
        }
        table[k] = crc;
        k += 1;
    }
    table
};
