// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Text from the bytes of a file.

use palpate_mesh::utf16_is_little_endian;

/// The bytes of a file as text: UTF-8, with or without a byte order mark, which is left out.
///
/// # Errors
///
/// If the bytes are not UTF-8: what they are, or which byte is wrong.
///
/// ```
/// use palpate_scene::utf8;
///
/// assert_eq!(utf8(b"\xef\xbb\xbfx_m,y_m\n"), Ok("x_m,y_m\n"));
/// let error = utf8(b"\xff\xfex\0_\0m\0").unwrap_err();
/// assert!(error.to_string().starts_with("the file is UTF-16 (little-endian)"));
/// ```
pub fn utf8(bytes: &[u8]) -> Result<&str, NotUtf8> {
    if let Some(is_little_endian) = utf16_is_little_endian(bytes) {
        return Err(NotUtf8::Utf16 { is_little_endian });
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let offset = error.valid_up_to();
        let before = bytes.get(..offset).unwrap_or_default();
        NotUtf8::Byte {
            offset,
            line: 1 + before.iter().filter(|byte| **byte == b'\n').count(),
            byte: bytes.get(offset).copied().unwrap_or_default(),
        }
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// Why the bytes of a file are no text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NotUtf8 {
    /// The text is UTF-16, as Windows PowerShell writes with `>` and spreadsheets as "Unicode
    /// text".
    #[error(
        "the file is UTF-16 ({endian}-endian); save it as UTF-8, for example with \
         `iconv -f UTF-16{short} -t UTF-8`",
        endian = if *is_little_endian { "little" } else { "big" },
        short = if *is_little_endian { "LE" } else { "BE" },
    )]
    Utf16 {
        /// The order of the two bytes of a unit.
        is_little_endian: bool,
    },
    /// A byte cannot stand where it does in UTF-8.
    #[error(
        "the file is not UTF-8: byte {offset}, in line {line}, is {byte:#04x}; save it as UTF-8"
    )]
    Byte {
        /// The place of the byte in the file, from 0.
        offset: usize,
        /// Its line, from 1.
        line: usize,
        /// The byte.
        byte: u8,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn utf_16_is_known_with_and_without_a_mark() {
        let little: Vec<u8> = "{ \"é\"".encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = "{ \"é\"".encode_utf16().flat_map(u16::to_be_bytes).collect();
        let marked = |mark: [u8; 2], text: &[u8]| [&mark[..], text].concat();
        for (bytes, is_little_endian) in [
            (little.clone(), true),
            (big.clone(), false),
            (marked([0xff, 0xfe], &little), true),
            (marked([0xfe, 0xff], &big), false),
        ] {
            assert_eq!(utf8(&bytes), Err(NotUtf8::Utf16 { is_little_endian }), "{bytes:?}");
        }
    }

    #[test]
    fn a_byte_that_is_wrong_is_named() {
        let error = utf8(b"a\nb\xff").unwrap_err();
        assert_eq!(
            error.to_string(),
            "the file is not UTF-8: byte 3, in line 2, is 0xff; save it as UTF-8"
        );
        for good in [&b""[..], b"{", b"{}", "é".as_bytes()] {
            assert!(utf8(good).is_ok(), "{good:?}");
        }
    }
}
