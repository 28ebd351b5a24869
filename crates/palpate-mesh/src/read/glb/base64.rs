// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Data within a text (RFC 2397), in base 64 (RFC 4648).

/// The bytes of a URI such as `data:application/octet-stream;base64,AAAA`; `None` if it is no
/// such URI.
pub(super) fn of_uri(uri: &str) -> Option<Vec<u8>> {
    let (head, text) = uri.strip_prefix("data:")?.split_once(',')?;
    head.ends_with(";base64").then(|| decoded(text.trim_end_matches('=').as_bytes()))?
}

fn decoded(letters: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(letters.len() / 4 * 3 + 2);
    for group in letters.chunks(4) {
        let mut bits = 0;
        for letter in group {
            bits = bits << 6 | value(*letter)?;
        }
        // The bits that a shorter last group lacks.
        bits <<= 6 * (4 - group.len());
        let kept = match group.len() {
            1 => return None,
            letters => letters - 1,
        };
        bytes.extend(&bits.to_be_bytes()[1..=kept]);
    }
    Some(bytes)
}

fn value(letter: u8) -> Option<u32> {
    let value = match letter {
        b'A'..=b'Z' => letter - b'A',
        b'a'..=b'z' => letter - b'a' + 26,
        b'0'..=b'9' => letter - b'0' + 52,
        b'+' | b'-' => 62,
        b'/' | b'_' => 63,
        _ => return None,
    };
    Some(u32::from(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The examples of RFC 4648, section 10.
    #[test]
    fn texts_of_every_length_are_decoded() {
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYg==", "foob"),
            ("Zm9vYmE=", "fooba"),
            ("Zm9vYmFy", "foobar"),
        ] {
            let uri = format!("data:application/octet-stream;base64,{text}");
            assert_eq!(of_uri(&uri).as_deref(), Some(bytes.as_bytes()), "{text}");
        }
        assert_eq!(of_uri("data:;base64,+/-_"), Some(vec![0xfb, 0xff, 0xbf]));
        for wrong in ["mesh.bin", "data:,abc", "data:;base64,Z", "data:;base64,Z!=="] {
            assert_eq!(of_uri(wrong), None, "{wrong}");
        }
    }
}
