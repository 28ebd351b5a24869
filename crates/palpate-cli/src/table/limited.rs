// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Reads the bytes of a table. It refuses a row, or a table, with too many bytes.

use std::io::{self, BufRead, Error, ErrorKind, Read};

use palpate::scene::too_large;

/// The longest row, with the empty lines before it [bytes]: a row is in memory as a whole.
const LONGEST_ROW: u64 = 1 << 20;

/// A reader that ends with an error where there are too many bytes: of kind
/// [`ErrorKind::FileTooLarge`] of all, and of kind [`ErrorKind::InvalidData`] of a row.
pub(super) struct Limited<R> {
    inner: R,
    /// The most bytes of all.
    most: u64,
    /// How many more are read.
    left: u64,
    /// How many more are read until the next row begins.
    left_of_row: u64,
}

impl<R: BufRead> Limited<R> {
    pub(super) fn new(inner: R, most: u64) -> Self {
        Self { inner, most, left: most, left_of_row: LONGEST_ROW }
    }

    /// Begins a row.
    pub(super) fn begin_row(&mut self) {
        self.left_of_row = LONGEST_ROW;
    }
}

impl<R: BufRead> Read for Limited<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let there = self.inner.fill_buf()?;
        let left = self.left.min(self.left_of_row);
        if !there.is_empty() && left == 0 {
            return Err(if self.left == 0 { too_large(self.most) } else { row_too_long() });
        }
        let room = usize::try_from(left).unwrap_or(usize::MAX);
        let count = there.len().min(buffer.len()).min(room);
        buffer[..count].copy_from_slice(&there[..count]);
        self.inner.consume(count);
        self.left -= count as u64;
        self.left_of_row -= count as u64;
        Ok(count)
    }
}

fn row_too_long() -> Error {
    let problem = format!(
        "the row is longer than {LONGEST_ROW} bytes, the most that are read of one; a row ends with its \
         line, unless a quote is open"
    );
    Error::new(ErrorKind::InvalidData, problem)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_bytes_as_are_allowed_are_read() {
        let mut text = String::new();
        Limited::new(&b"x_m,y_m\n"[..], 8).read_to_string(&mut text).unwrap();
        assert_eq!(text, "x_m,y_m\n");
        let refused = Limited::new(&b"x_m,y_m\n"[..], 7).read_to_string(&mut text).unwrap_err();
        assert_eq!(refused.to_string(), too_large(7).to_string());
    }

    #[test]
    fn a_row_without_end_is_refused_and_many_rows_are_not() {
        let endless = || io::BufReader::new(io::repeat(b'1'));
        let refused = io::copy(&mut Limited::new(endless(), u64::MAX), &mut io::sink());
        assert!(refused.unwrap_err().to_string().contains("longer than 1048576 bytes"));
        let mut rows = Limited::new(endless(), u64::MAX);
        let mut row = vec![0; LONGEST_ROW as usize];
        for _ in 0..3 {
            rows.begin_row();
            rows.read_exact(&mut row).unwrap();
        }
    }
}
