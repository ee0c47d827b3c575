//! The bytes behind a glTF file: its binary chunk, files beside it, and data URIs.

use std::borrow::Cow;
use std::path::Path;

use crate::asset::error::Flaw;
use crate::asset::files::Files;
use crate::asset::memory::Memory;

/// The contents of all buffers, and where files beside the glTF file are.
pub(super) struct Buffers<'a> {
    gltf: &'a gltf::Gltf,
    folder: &'a Path,
    files: &'a Files,
    buffers: Vec<Cow<'a, [u8]>>,
}

impl<'a> Buffers<'a> {
    /// Reads all buffers; relative URIs are relative to `folder`.
    pub fn read(gltf: &'a gltf::Gltf, folder: &'a Path, files: &'a Files) -> Result<Self, Flaw> {
        let read = |buffer: gltf::Buffer| {
            let bytes = match buffer.source() {
                gltf::buffer::Source::Bin => gltf.blob.as_deref().map(Cow::Borrowed).ok_or_else(|| {
                    Flaw::new("the binary chunk is missing", "the file is cut off; copy or export it again")
                }),
                gltf::buffer::Source::Uri(uri) => read_uri(uri, folder, files).map(Cow::Owned),
            }
            .map_err(|flaw| flaw.at(format!("buffer {}", buffer.index())))?;
            if bytes.len() >= buffer.length() {
                return Ok(bytes);
            }
            Err(Flaw::new(
                format!("buffer {} has {} bytes instead of {}", buffer.index(), bytes.len(), buffer.length()),
                "the file is cut off; copy or export it again",
            ))
        };
        Ok(Self { gltf, folder, files, buffers: gltf.buffers().map(read).collect::<Result<_, _>>()? })
    }

    /// How much memory may be used.
    pub fn memory(&self) -> Memory {
        self.files.memory()
    }

    /// The bytes of a buffer view.
    pub fn view(&self, view: &gltf::buffer::View) -> Result<&[u8], Flaw> {
        let end = view.offset().checked_add(view.length());
        let bytes = self.buffers.get(view.buffer().index());
        bytes.zip(end).and_then(|(bytes, end)| bytes.get(view.offset()..end)).ok_or_else(|| {
            Flaw::new(
                format!("buffer view {} reaches beyond its buffer", view.index()),
                "the file is damaged; export it again",
            )
        })
    }

    /// The bytes of an encoded image.
    ///
    /// Goes by the JSON, since the crate's `Image::source` panics on an image without media type.
    pub fn image(&self, image: &gltf::Image) -> Result<Cow<'_, [u8]>, Flaw> {
        let json = self.gltf.document.as_json().images.get(image.index());
        let view = json.and_then(|json| self.gltf.views().nth(json.buffer_view?.value()));
        let uri = json.and_then(|json| json.uri.as_deref());
        match (view, uri) {
            (Some(view), _) => self.view(&view).map(Cow::Borrowed),
            (None, Some(uri)) => read_uri(uri, self.folder, self.files).map(Cow::Owned),
            (None, None) => Err(Flaw::new("the image has no data", "export the file again")),
        }
    }
}

/// Reads a data URI or a file.
fn read_uri(uri: &str, folder: &Path, files: &Files) -> Result<Vec<u8>, Flaw> {
    if let Some(data) = uri.strip_prefix("data:") {
        let encoded = data.split_once(";base64,").map(|(_, encoded)| encoded);
        return encoded.and_then(decode_base64).ok_or_else(|| {
            Flaw::new("the data URI is not base64", "export with a separate .bin file or as .glb")
        });
    }
    let path = folder.join(decode_percent(uri));
    files.read(&path).map_err(|error| {
        Flaw::new(format!("{} cannot be read: {error}", path.display()), "put the file beside the .gltf file")
    })
}

/// Standard base64 (RFC 4648) with or without padding.
fn decode_base64(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut count) = (0u32, 0);
    for symbol in text.trim_end_matches('=').bytes() {
        let value = match symbol {
            b'A'..=b'Z' => symbol - b'A',
            b'a'..=b'z' => symbol - b'a' + 26,
            b'0'..=b'9' => symbol - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
            bits &= (1 << count) - 1;
        }
    }
    Some(bytes)
}

/// `%20` and the like become the bytes they stand for.
fn decode_percent(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        let escaped = match rest {
            [b'%', high, low, tail @ ..] => {
                hex(*high).zip(hex(*low)).map(|(high, low)| (high << 4 | low, tail))
            }
            _ => None,
        };
        let (byte, tail) = escaped.unwrap_or((*first, tail));
        bytes.push(byte);
        rest = tail;
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

fn hex(digit: u8) -> Option<u8> {
    (digit as char).to_digit(16).map(|value| value as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_decodes_with_and_without_padding() {
        assert_eq!(decode_base64("SGVsbG8="), Some(b"Hello".to_vec()));
        assert_eq!(decode_base64("SGVsbG8"), Some(b"Hello".to_vec()));
        assert_eq!(decode_base64("+/8="), Some(vec![0xfb, 0xff]));
        assert_eq!(decode_base64("a b"), None);
    }

    #[test]
    fn percent_escapes_decode_and_broken_ones_stay() {
        assert_eq!(decode_percent("my%20mesh%2e.bin%"), "my mesh..bin%");
        assert_eq!(decode_percent("%zz"), "%zz");
    }
}
