//! The two containers of glTF: a text file, and GLB with its chunks.

use std::ops::Range;

use gltf::json::Root;

use crate::asset::flaw::Flaw;

/// First bytes of a GLB file.
const MAGIC: &[u8] = b"glTF";
/// Bytes of a GLB header: magic, version, length.
const HEADER: usize = 12;
/// Bytes in front of the data of a chunk: length, type.
const CHUNK_HEADER: usize = 8;

/// Reads the JSON and the binary chunk of a file.
pub(super) fn open(bytes: Vec<u8>) -> Result<gltf::Gltf, Flaw> {
    let (json, binary) = match bytes.starts_with(MAGIC) {
        true => chunks(&bytes)?,
        false => (0..bytes.len(), None),
    };
    let root = parse(bytes.get(json).unwrap_or_default())?;
    let blob = binary.map(|binary| cut_out(bytes, binary));
    Ok(gltf::Gltf { document: gltf::Document::from_json_without_validation(root), blob })
}

/// Ranges of the JSON chunk and of the binary chunk; chunks of other types, and bytes behind the last, are passed over.
fn chunks(bytes: &[u8]) -> Result<(Range<usize>, Option<Range<usize>>), Flaw> {
    let cut_off = || {
        Flaw::new(
            format!("the file is cut off: it has {} bytes and its header promises more", bytes.len()),
            "copy or export the file again",
        )
    };
    match word(bytes, 4) {
        Some(2) => {}
        None => return Err(cut_off()),
        Some(version) => {
            let problem = format!("GLB version {version} cannot be read, only version 2");
            return Err(Flaw::new(problem, "export the file as glTF 2.0"));
        }
    }
    let end = word(bytes, 8).filter(|end| (HEADER..=bytes.len()).contains(end)).ok_or_else(cut_off)?;
    let (mut json, mut binary) = (None, None);
    let mut at = HEADER;
    while at + CHUNK_HEADER <= end {
        let data = at + CHUNK_HEADER;
        let next = word(bytes, at).and_then(|length| data.checked_add(length));
        let next = next.filter(|next| *next <= bytes.len()).ok_or_else(cut_off)?;
        match bytes.get(at + 4..data) {
            Some(b"JSON") => json = json.or(Some(data..next)),
            Some(b"BIN\0") => binary = binary.or(Some(data..next)),
            _ => {}
        }
        at = next;
    }
    let json = json.ok_or_else(|| Flaw::new("there is no JSON chunk", "export the file again"))?;
    Ok((json, binary))
}

/// Little-endian integer of 32 bits.
fn word(bytes: &[u8], at: usize) -> Option<usize> {
    let field = bytes.get(at..)?.first_chunk()?;
    usize::try_from(u32::from_le_bytes(*field)).ok()
}

/// The bytes of a range, in the memory that they are in.
fn cut_out(mut bytes: Vec<u8>, range: Range<usize>) -> Vec<u8> {
    bytes.truncate(range.end);
    bytes.drain(..range.start);
    bytes
}

/// Reads JSON, of which a byte order mark, padding, and names that are not UTF-8 are forgiven.
fn parse(bytes: &[u8]) -> Result<Root, Flaw> {
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err(Flaw::new("the text is UTF-16", "save it as UTF-8"));
    }
    let text = String::from_utf8_lossy(bytes);
    let text = text.trim_start_matches('\u{feff}').trim_end_matches(|c: char| c == '\0' || c.is_whitespace());
    if text.is_empty() {
        return Err(Flaw::new("the file is empty", "copy or export the file again"));
    }
    gltf::json::deserialize::from_str(text)
        .map_err(|error| Flaw::new(format!("not a glTF 2.0 file: {error}"), "export the file as glTF 2.0"))
}
