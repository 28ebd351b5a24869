// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! UTF-16, as text files that need UTF-8 may have it.

/// `Some(true)` for UTF-16 of little-endian units, `Some(false)` for big-endian ones. Without a
/// byte order mark a text whose first character is of ASCII is known by the zero beside it.
#[must_use]
pub fn utf16_is_little_endian(bytes: &[u8]) -> Option<bool> {
    match bytes {
        [0xff, 0xfe, ..] | [1..=255, 0, 1..=255, 0, ..] | [1..=255, 0] => Some(true),
        [0xfe, 0xff, ..] | [0, 1..=255, 0, 1..=255, ..] | [0, 1..=255] => Some(false),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn utf_16_is_known_with_and_without_a_mark() {
        for (bytes, is_little) in [
            (&b"\xff\xfe"[..], Some(true)),
            (b"v\0 \x001\0", Some(true)),
            (b"\xfe\xff", Some(false)),
            (b"\0v\0 ", Some(false)),
            (b"\0v", Some(false)),
            (b"v 0 0 0", None),
            (b"\xef\xbb\xbfv", None),
            (b"\0\0\0\0", None),
            (b"", None),
        ] {
            assert_eq!(utf16_is_little_endian(bytes), is_little, "{bytes:?}");
        }
    }
}
