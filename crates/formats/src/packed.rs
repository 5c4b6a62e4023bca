//! Files as they are kept: plain, or packed by gzip (RFC 1952), Unix compress (`.Z`) or zip.

mod compress;
mod zip;

use crate::refusal::Unreadable;
use flate2::bufread::MultiGzDecoder;
use std::borrow::Cow;
use std::io::Read;

/// Largest plain size that is unpacked \[bytes\]: fifty times the largest daily file, and no bomb.
const LARGEST: u64 = 4 << 30;

/// The plain bytes of a file.
///
/// # Errors
/// [`Unreadable`] for a damaged stream, one of more than 4 GiB, an archive of several files, or another packing (bzip2, xz), which is named.
pub fn unpack(bytes: &[u8]) -> Result<Cow<'_, [u8]>, Unreadable> {
    match bytes {
        [0x1f, 0x8b, ..] => gunzip(bytes).map(Cow::Owned),
        [0x1f, 0x9d, stream @ ..] => {
            let damaged = |e| Unreadable::whole(format!("the compress (.Z) stream is damaged: {e}"));
            compress::unpack(stream, LARGEST).map(Cow::Owned).map_err(damaged)
        }
        [b'P', b'K', 3, 4, ..] | [b'P', b'K', 5, 6, ..] => {
            zip::unpack(bytes, LARGEST).map(Cow::Owned).map_err(|e| Unreadable::whole(format!("the zip archive cannot be read: {e}")))
        }
        [b'B', b'Z', b'h', ..] => Err(other("bzip2")),
        [0xfd, b'7', b'z', b'X', b'Z', ..] => Err(other("xz")),
        _ => Ok(Cow::Borrowed(bytes)),
    }
}

fn other(packing: &str) -> Unreadable {
    Unreadable::whole(format!("the file is packed by {packing}; unpack it, or pack it by gzip"))
}

fn gunzip(bytes: &[u8]) -> Result<Vec<u8>, Unreadable> {
    // The last four bytes hold the plain size modulo 2^32: a hint for the first allocation, never more than deflate can expand to.
    let stated = bytes.last_chunk::<4>().map_or(0, |b| u32::from_le_bytes(*b) as usize);
    let mut plain = Vec::with_capacity(stated.min(bytes.len().saturating_mul(1032)));
    let damaged = |e: std::io::Error| Unreadable::whole(format!("the gzip stream is damaged: {e}"));
    MultiGzDecoder::new(bytes).take(LARGEST + 1).read_to_end(&mut plain).map_err(damaged)?;
    if plain.len() as u64 > LARGEST {
        return Err(Unreadable::whole("the file unpacks to more than 4 GiB"));
    }
    Ok(plain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn gzip(plain: &[u8]) -> Vec<u8> {
        let mut e = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
        e.write_all(plain).unwrap();
        e.finish().unwrap()
    }

    #[test]
    fn plain_files_pass_and_gzip_files_are_unpacked_member_by_member() {
        assert_eq!(&*unpack(b"plain").unwrap(), b"plain");
        let two = [gzip(b"first "), gzip(b"second")].concat();
        assert_eq!(&*unpack(&two).unwrap(), b"first second");
    }

    #[test]
    fn a_gzip_file_cut_short_or_changed_is_refused() {
        let whole = gzip(&[b'x'; 1000]);
        assert!(unpack(&whole[..whole.len() - 9]).unwrap_err().reason.contains("gzip"));
        let mut changed = whole.clone();
        let last = changed.len() - 6;
        changed[last] ^= 1;
        assert!(unpack(&changed).unwrap_err().reason.contains("damaged"));
    }

    #[test]
    fn other_packings_are_named() {
        assert!(unpack(b"BZh9").unwrap_err().reason.contains("bzip2"));
    }
}
