//! The text of a scene file.

use std::path::Path;

use super::error::{Fault, SceneError, SourceText};

/// Decodes UTF-8, with or without byte order mark.
///
/// # Errors
/// The text is in another encoding; the place of the first odd byte is told.
pub(super) fn decode(path: &Path, bytes: Vec<u8>) -> Result<String, SceneError> {
    if let Some(encoding) = wide(&bytes) {
        let fault = Fault::whole(
            format!("the file is in {encoding}, and a scene file is in UTF-8"),
            "save it as UTF-8; Windows PowerShell writes that with `Out-File -Encoding utf8`",
        );
        return Err(SourceText { path, text: "", on_disk: Some("") }.locate(fault));
    }
    String::from_utf8(bytes).map_err(|error| {
        let start = error.utf8_error().valid_up_to();
        let byte = error.as_bytes().get(start).copied().unwrap_or_default();
        let problem = format!("the byte {byte:#04x} is not UTF-8, in which a scene file is encoded");
        let fault = Fault::at(start..start + 1, problem, "save the file as UTF-8");
        let text = String::from_utf8_lossy(error.as_bytes());
        SourceText { path, text: &text, on_disk: Some(&text) }.locate(fault)
    })
}

/// The encoding of a text of two or four bytes per letter, by its byte order mark or by the zeros of its first letter.
fn wide(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0xff, 0xfe, 0, 0, ..] | [0, 0, 0xfe, 0xff, ..] => Some("UTF-32"),
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => Some("UTF-16"),
        [0, 0, 0, letter, ..] | [letter, 0, 0, 0, ..] if *letter != 0 => Some("UTF-32"),
        [0, letter, ..] | [letter, 0, ..] if *letter != 0 => Some("UTF-16"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn failure(bytes: &[u8]) -> String {
        decode(Path::new("a.toml"), bytes.to_vec()).unwrap_err().to_string()
    }

    #[test]
    fn other_encodings_are_named() {
        let wide = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
        let big = |text: &str| text.encode_utf16().flat_map(u16::to_be_bytes).collect::<Vec<u8>>();
        for text in ["[camera]", "\u{feff}[camera]"] {
            assert!(failure(&wide(text)).starts_with("a.toml: the file is in UTF-16"));
            assert!(failure(&big(text)).starts_with("a.toml: the file is in UTF-16"));
            let utf32: Vec<u8> = text.chars().flat_map(|letter| (letter as u32).to_le_bytes()).collect();
            assert!(failure(&utf32).contains("UTF-32"));
        }
    }

    #[test]
    fn the_first_odd_byte_has_its_line() {
        let message = failure(b"# scene\n[camera]\nname = \"caf\xe9\"\n");
        assert!(message.starts_with("a.toml:3:12: the byte 0xe9"), "{message}");
    }

    #[test]
    fn utf8_is_taken_as_it_is() {
        for text in ["", "a", "\u{feff}a = 1", "Würfel"] {
            assert_eq!(decode(Path::new("a"), text.as_bytes().to_vec()).unwrap(), text);
        }
    }
}
