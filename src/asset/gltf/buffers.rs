//! The bytes behind a glTF file: its binary chunk, files beside it, and data URIs.

use std::borrow::Cow;
use std::collections::HashMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use data_url::DataUrl;
use percent_encoding::percent_decode_str;

use crate::asset::files::Files;
use crate::asset::flaw::Flaw;
use crate::asset::memory::Memory;
use crate::text;

/// The contents of all buffers, and where files beside the glTF file are.
pub(super) struct Buffers<'a> {
    gltf: &'a gltf::Gltf,
    folder: &'a Path,
    files: &'a Files,
    /// Each content once, however many buffers have its address.
    contents: Vec<Cow<'a, [u8]>>,
    /// Index in `contents` of each buffer.
    buffers: Vec<usize>,
}

impl<'a> Buffers<'a> {
    /// Reads all buffers; relative URIs are relative to `folder`.
    pub fn read(gltf: &'a gltf::Gltf, folder: &'a Path, files: &'a Files) -> Result<Self, Flaw> {
        let mut read = Self { gltf, folder, files, contents: Vec::new(), buffers: Vec::new() };
        let mut known = HashMap::new();
        for buffer in gltf.buffers() {
            let place = |flaw: Flaw| flaw.at(format!("buffer {}", buffer.index()));
            let address = match buffer.source() {
                gltf::buffer::Source::Bin => None,
                gltf::buffer::Source::Uri(uri) => Some(uri),
            };
            let index = match known.get(&address) {
                Some(index) => *index,
                None => {
                    read.contents.push(content(gltf, address, folder, files).map_err(place)?);
                    known.insert(address, read.contents.len() - 1);
                    read.contents.len() - 1
                }
            };
            read.buffers.push(index);
            let length = read.content(buffer.index()).map_or(0, <[u8]>::len);
            if length < buffer.length() {
                let problem = format!("it has {length} bytes instead of {}", buffer.length());
                return Err(place(Flaw::new(problem, "the file is cut off; copy or export it again")));
            }
        }
        Ok(read)
    }

    /// Bytes of all contents.
    pub fn size(&self) -> usize {
        self.contents.iter().map(|content| content.len()).sum()
    }

    fn content(&self, buffer: usize) -> Option<&[u8]> {
        self.contents.get(*self.buffers.get(buffer)?).map(AsRef::as_ref)
    }

    /// Memory that may be used.
    pub fn memory(&self) -> Memory {
        self.files.memory()
    }

    /// The bytes of a buffer view.
    pub fn view(&self, view: &gltf::buffer::View) -> Result<&[u8], Flaw> {
        let end = view.offset().checked_add(view.length());
        let bytes = self.content(view.buffer().index());
        bytes.zip(end).and_then(|(bytes, end)| bytes.get(view.offset()..end)).ok_or_else(|| {
            Flaw::new(
                format!("buffer view {} reaches beyond its buffer", view.index()),
                "the file is damaged; export it again",
            )
        })
    }

    /// The bytes of an encoded image.
    pub fn image(&self, image: ImageSource) -> Result<Cow<'_, [u8]>, Flaw> {
        match image {
            ImageSource::View(index) => match self.gltf.views().nth(index) {
                Some(view) => self.view(&view).map(Cow::Borrowed),
                None => Err(Flaw::new("the image has no data", "export the file again")),
            },
            ImageSource::Uri(uri) => read_uri(uri, self.folder, self.files).map(Cow::Owned),
        }
    }
}

/// Source of an encoded image; images with the same one are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum ImageSource<'a> {
    /// Index of a buffer view.
    View(usize),
    /// Address of a file, or a data URI.
    Uri(&'a str),
}

impl<'a> ImageSource<'a> {
    /// Goes by the JSON, since the crate's `Image::source` panics on an image without media type or address.
    pub fn of(gltf: &'a gltf::Gltf, image: &gltf::Image) -> Option<Self> {
        let json = gltf.document.as_json().images.get(image.index())?;
        let view = json.buffer_view.map(|view| Self::View(view.value()));
        view.or_else(|| json.uri.as_deref().map(Self::Uri))
    }
}

/// The binary chunk, or what is at an address.
fn content<'a>(
    gltf: &'a gltf::Gltf,
    address: Option<&str>,
    folder: &Path,
    files: &Files,
) -> Result<Cow<'a, [u8]>, Flaw> {
    match address {
        Some(uri) => read_uri(uri, folder, files).map(Cow::Owned),
        None => gltf.blob.as_deref().map(Cow::Borrowed).ok_or_else(|| {
            Flaw::new("the binary chunk is missing", "the file is cut off; copy or export it again")
        }),
    }
}

/// Tells `files` which hold the images, also those of textures that are not read.
pub(super) fn mention_images(gltf: &gltf::Gltf, folder: &Path, files: &Files) {
    let addresses = gltf.document.as_json().images.iter().filter_map(|image| image.uri.as_deref());
    for address in addresses.filter(|address| !is_data(address.trim_start())) {
        names(address).iter().for_each(|name| files.mention(&folder.join(name.as_ref())));
    }
}

fn is_data(uri: &str) -> bool {
    uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"))
}

/// Reads a data URI or a file.
fn read_uri(uri: &str, folder: &Path, files: &Files) -> Result<Vec<u8>, Flaw> {
    let start = uri.trim_start();
    if is_data(start) {
        return read_data_uri(start);
    }
    if start.contains("://") {
        return Err(Flaw::new(
            format!("{} is an address, and addresses are not followed", text::quoted(start)),
            "put the file beside the .gltf file, and its name into it",
        ));
    }
    read_file(uri, folder, files)
}

/// Decodes a data URI, as forgiving as browsers: any case, white space anywhere, with or without media type and
/// padding, base64 or not.
fn read_data_uri(uri: &str) -> Result<Vec<u8>, Flaw> {
    let help = "export with a separate .bin file or as .glb";
    let data =
        DataUrl::process(uri).map_err(|_| Flaw::new("the data URI has no comma before its data", help))?;
    let decoded = data.decode_to_vec();
    decoded.map(|(bytes, _)| bytes).map_err(|_| Flaw::new("the data URI is not base64", help))
}

/// Reads the first file that there is of those that an address may mean.
fn read_file(uri: &str, folder: &Path, files: &Files) -> Result<Vec<u8>, Flaw> {
    let paths: Vec<PathBuf> = names(uri).iter().map(|name| folder.join(name.as_ref())).collect();
    let mut failed = Vec::new();
    for path in &paths {
        match files.read(path) {
            Ok(bytes) => return Ok(bytes),
            Err(error) if error.kind() == ErrorKind::NotFound => failed.push((path, error)),
            Err(error) => {
                failed = vec![(path, error)];
                break;
            }
        }
    }
    let problems: Vec<String> =
        failed.iter().map(|(path, error)| format!("{} cannot be read: {error}", path.display())).collect();
    Err(Flaw::new(problems.join("; "), "put the file beside the .gltf file"))
}

/// The names that an address may stand for, each once: its escapes decoded, as it stands, and with slashes for
/// backslashes.
fn names(uri: &str) -> Vec<Cow<'_, str>> {
    let decoded = percent_decode_str(uri).decode_utf8_lossy();
    let slashes = decoded.replace('\\', "/");
    let mut names = vec![decoded];
    for name in [Cow::Borrowed(uri), Cow::Owned(slashes)] {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_uris_are_read_as_browsers_read_them() {
        for uri in [
            "data:application/octet-stream;base64,SGVsbG8=",
            "data:;base64,SGVsbG8",
            "data:base64;base64,SGVsbG8=",
            "DATA:Application/Octet-Stream;BASE64,SGVsbG8=",
            "data:application/gltf-buffer;charset=x;base64,SGVs\r\n  bG8=\n",
            "data:;base64 ,SGVsbG8%3D",
            "data:,Hello",
            "data:text/plain,H%65llo",
        ] {
            assert_eq!(read_data_uri(uri), Ok(b"Hello".to_vec()), "{uri}");
        }
        assert_eq!(read_data_uri("data:;base64,+/8="), Ok(vec![0xfb, 0xff]));
        assert!(read_data_uri("data:;base64,a-b").unwrap_err().problem.contains("not base64"));
        assert!(read_data_uri("data:;base64").unwrap_err().problem.contains("comma"));
    }

    #[test]
    fn an_address_stands_for_its_decoded_name_first_and_then_for_itself() {
        assert_eq!(names("a.bin"), ["a.bin"]);
        assert_eq!(names("my%20mesh%2e.bin%"), ["my mesh..bin%", "my%20mesh%2e.bin%"]);
        assert_eq!(names("%zz"), ["%zz"]);
        assert_eq!(
            names("textures\\a%20b.png"),
            ["textures\\a b.png", "textures\\a%20b.png", "textures/a b.png"]
        );
    }
}
