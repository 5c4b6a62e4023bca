//! Zip archives of one file, stored or deflated (PKWARE APPNOTE; provenance: standard).

use flate2::Crc;
use flate2::bufread::DeflateDecoder;
use std::io::Read;

const END: &[u8] = b"PK\x05\x06";
const ENTRY: &[u8] = b"PK\x01\x02";
const LOCAL: &[u8] = b"PK\x03\x04";
const END_BYTES: usize = 22;
const ENTRY_BYTES: usize = 46;
const LOCAL_BYTES: usize = 30;

/// One file of an archive, as its list of contents has it.
struct Entry<'a> {
    name: &'a [u8],
    flags: u16,
    method: u16,
    crc: u32,
    packed: usize,
    plain: u64,
    at: usize,
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    bytes.get(at..at + 2)?.first_chunk().map(|b| u16::from_le_bytes(*b))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..at.checked_add(4)?)?.first_chunk().map(|b| u32::from_le_bytes(*b))
}

/// The only file in an archive, at most `largest` bytes.
pub(super) fn unpack(bytes: &[u8], largest: u64) -> Result<Vec<u8>, String> {
    let entries = contents(bytes).ok_or("its list of contents is missing or damaged: the archive is cut or no zip")?;
    let files: Vec<&Entry<'_>> = entries.iter().filter(|e| !e.name.ends_with(b"/")).collect();
    match files.as_slice() {
        [one] => content(bytes, one, largest),
        [] => Err("it holds no file".to_owned()),
        several => {
            let names = several.iter().take(4).map(|e| String::from_utf8_lossy(e.name)).collect::<Vec<_>>().join(", ");
            Err(format!("it holds {} files ({names}): unpack it and name the one that is meant", several.len()))
        }
    }
}

/// The list of contents; none where it cannot be followed.
fn contents(bytes: &[u8]) -> Option<Vec<Entry<'_>>> {
    // It ends the archive, behind it stands at most a comment of 65535 bytes.
    let from = bytes.len().saturating_sub(END_BYTES + usize::from(u16::MAX));
    let end = from + memchr::memmem::rfind(&bytes[from..], END)?;
    let (count, mut at) = (u16_at(bytes, end + 10)?, u32_at(bytes, end + 16)? as usize);
    let mut entries = Vec::new();
    for _ in 0..count {
        let head = bytes.get(at..at + ENTRY_BYTES).filter(|h| h.starts_with(ENTRY))?;
        let after = |k| u16_at(head, k).map(usize::from);
        let name = bytes.get(at + ENTRY_BYTES..at + ENTRY_BYTES + after(28)?)?;
        entries.push(Entry {
            name,
            flags: u16_at(head, 8)?,
            method: u16_at(head, 10)?,
            crc: u32_at(head, 16)?,
            packed: u32_at(head, 20)? as usize,
            plain: u64::from(u32_at(head, 24)?),
            at: u32_at(head, 42)? as usize,
        });
        at += ENTRY_BYTES + after(28)? + after(30)? + after(32)?;
    }
    Some(entries)
}

fn content(bytes: &[u8], entry: &Entry<'_>, largest: u64) -> Result<Vec<u8>, String> {
    if entry.flags & 1 != 0 {
        return Err("its file is encrypted".to_owned());
    }
    if entry.plain > largest {
        return Err(format!("it unpacks to more than {largest} bytes"));
    }
    let packed = stored(bytes, entry).ok_or("its file is cut or lies outside the archive")?;
    let mut plain = Vec::new();
    match entry.method {
        0 => plain.extend_from_slice(packed),
        8 => {
            let size = DeflateDecoder::new(packed).take(entry.plain + 1).read_to_end(&mut plain);
            size.map_err(|e| format!("its deflate stream is damaged: {e}"))?;
        }
        other => return Err(format!("its file is packed by method {other}; stored and deflated ones are read")),
    }
    let mut crc = Crc::new();
    crc.update(&plain);
    if plain.len() as u64 != entry.plain || crc.sum() != entry.crc {
        return Err("its file does not have the stated length and checksum".to_owned());
    }
    Ok(plain)
}

/// The packed bytes of a file.
fn stored<'a>(bytes: &'a [u8], entry: &Entry<'_>) -> Option<&'a [u8]> {
    let head = bytes.get(entry.at..entry.at.checked_add(LOCAL_BYTES)?).filter(|h| h.starts_with(LOCAL))?;
    let from = entry.at + LOCAL_BYTES + usize::from(u16_at(head, 26)?) + usize::from(u16_at(head, 28)?);
    bytes.get(from..from.checked_add(entry.packed)?)
}
