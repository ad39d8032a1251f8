//! A cursor over the bytes of a text format: blanks, line ends, words and numbers.
//!
//! Lines end at `\n`, `\r\n` or a lone `\r`; a backslash at the end of a line continues it.
//! Every step moves forward, so a file of any content is read in time linear in its length.

use std::borrow::Cow;

/// What is wrong at the cursor; the caller adds the file's name and the statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fault {
    /// The line ends before the number or within it.
    Missing,
    /// The word is no number.
    NotANumber,
    /// NaN, infinity, or beyond the range of `f32`.
    NotFinite,
    /// Index 0, or a negative one that reaches before the first element.
    OutOfRange,
}

/// The cursor. `line` counts from 1.
#[derive(Debug, Clone)]
pub(super) struct Scanner<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
}

impl<'a> Scanner<'a> {
    /// Starts at the first byte after a byte order mark.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        Self { bytes, at: 0, line: 1 }
    }

    /// The number of the line the cursor is on.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// Whether nothing is left.
    pub(super) fn is_at_end(&self) -> bool {
        self.at >= self.bytes.len()
    }

    /// Bytes that are left.
    pub(super) fn remaining(&self) -> usize {
        self.bytes.len().saturating_sub(self.at)
    }

    #[inline]
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    /// Length of the line end at `at`, or 0.
    fn line_end_length(&self, at: usize) -> usize {
        match self.bytes.get(at) {
            Some(b'\n') => 1,
            Some(b'\r') => 1 + usize::from(self.bytes.get(at + 1) == Some(&b'\n')),
            _ => 0,
        }
    }

    /// Skips spaces, tabs and continued line ends.
    #[inline]
    pub(super) fn skip_blanks(&mut self) {
        loop {
            match self.peek() {
                Some(b' ' | b'\t' | 0x0B | 0x0C) => self.at += 1,
                Some(b'\\') => {
                    let length = self.line_end_length(self.at + 1);
                    if length == 0 {
                        return;
                    }
                    self.at += 1 + length;
                    self.line += 1;
                }
                _ => return,
            }
        }
    }

    /// Whether the statement's words are over: line end, comment or end of file.
    #[inline]
    pub(super) fn is_at_line_end(&self) -> bool {
        matches!(self.peek(), None | Some(b'\n' | b'\r' | b'#'))
    }

    /// Whether a word that was being read is over.
    #[inline]
    fn is_at_word_end(&self) -> bool {
        match self.peek() {
            None | Some(b' ' | b'\t' | b'\n' | b'\r' | 0x0B | 0x0C) => true,
            Some(b'\\') => self.line_end_length(self.at + 1) > 0,
            _ => false,
        }
    }

    /// The bytes up to the next blank or line end; empty at a line end.
    pub(super) fn word(&mut self) -> &'a [u8] {
        let start = self.at;
        while !self.is_at_word_end() {
            self.at += 1;
        }
        &self.bytes[start..self.at]
    }

    /// Moves to the start of the next line. `#` hides a backslash: comments are not continued.
    pub(super) fn finish_line(&mut self) {
        let mut in_comment = false;
        while let Some(byte) = self.peek() {
            match byte {
                b'\n' | b'\r' => {
                    self.at += self.line_end_length(self.at);
                    self.line += 1;
                    return;
                }
                b'\\' if !in_comment => {
                    let length = self.line_end_length(self.at + 1);
                    self.at += 1 + length;
                    self.line += usize::from(length > 0);
                }
                _ => {
                    in_comment |= byte == b'#';
                    self.at += 1;
                }
            }
        }
    }

    /// The rest of the line without surrounding blanks, continued lines joined by a space.
    /// Borrowed when the bytes are already the text; `#` belongs to it, since names contain it.
    pub(super) fn rest_of_line(&mut self) -> Cow<'a, [u8]> {
        self.skip_blanks();
        let mut joined: Vec<u8> = Vec::new();
        let mut start = self.at;
        while let Some(byte) = self.peek() {
            let length = match byte {
                b'\n' | b'\r' => break,
                b'\\' => self.line_end_length(self.at + 1),
                _ => 0,
            };
            if length > 0 {
                joined.extend_from_slice(&self.bytes[start..self.at]);
                joined.push(b' ');
                self.at += length;
                self.line += 1;
                start = self.at + 1;
            }
            self.at += 1;
        }
        let last = &self.bytes[start..self.at];
        if joined.is_empty() {
            return Cow::Borrowed(last.trim_ascii());
        }
        joined.extend_from_slice(last);
        Cow::Owned(joined.trim_ascii().to_vec())
    }

    /// The next word as a finite `f32`, correctly rounded.
    #[inline]
    pub(super) fn number(&mut self) -> Result<f32, Fault> {
        self.skip_blanks();
        let start = self.at;
        if let Some(value) = self.plain_number()
            && self.is_at_word_end()
        {
            return Ok(value);
        }
        self.at = start;
        if self.is_at_line_end() {
            return Err(Fault::Missing);
        }
        parse_slowly(self.word())
    }

    /// [`Scanner::number`] as a call, for where speed is not all: inlined it is large.
    #[inline(never)]
    pub(super) fn next_number(&mut self) -> Result<f32, Fault> {
        self.number()
    }

    /// As [`Scanner::number`], but NaN for what is not finite.
    pub(super) fn number_or_nan(&mut self) -> Result<f32, Fault> {
        match self.next_number() {
            Err(Fault::NotFinite) => Ok(f32::NAN),
            result => result,
        }
    }

    /// The next word as an integer that `f64` holds exactly; any other number is taken too, since
    /// some programs write `255.0` for it.
    #[inline(never)]
    pub(super) fn integer(&mut self) -> Result<f64, Fault> {
        self.skip_blanks();
        let start = self.at;
        let negative = self.peek() == Some(b'-');
        self.at += usize::from(negative);
        let digits = self.at;
        let mut value = 0_u64;
        while let Some(digit @ b'0'..=b'9') = self.peek() {
            value = value.wrapping_mul(10).wrapping_add(u64::from(digit - b'0'));
            self.at += 1;
        }
        if (1..16).contains(&(self.at - digits)) && self.is_at_word_end() {
            #[allow(clippy::cast_precision_loss)] // 15 digits
            let magnitude = value as f64;
            return Ok(if negative { -magnitude } else { magnitude });
        }
        self.at = start;
        self.next_number().map(f64::from)
    }

    /// Steps over a word; `Missing` at the end of the line.
    pub(super) fn skip_word(&mut self) -> Result<(), Fault> {
        self.skip_blanks();
        if self.is_at_line_end() {
            return Err(Fault::Missing);
        }
        self.word();
        Ok(())
    }

    /// Moves to the next line that has more than blanks and a comment; a line with words is not left.
    #[inline(never)]
    pub(super) fn skip_blank_lines(&mut self) {
        loop {
            self.skip_blanks();
            if self.is_at_end() || !self.is_at_line_end() {
                return;
            }
            self.finish_line();
        }
    }

    /// The number at the cursor, if the result of a short calculation in `f64` is certain to
    /// round to the right `f32`. Otherwise `None`, with the cursor anywhere in the word.
    #[inline]
    fn plain_number(&mut self) -> Option<f32> {
        let negative = self.peek() == Some(b'-');
        if negative || self.peek() == Some(b'+') {
            self.at += 1;
        }
        // mantissa · 10^exponent. Digits after the 19th cannot matter: see the margin below.
        let (mut mantissa, mut exponent, mut digits) = (0_u64, 0_i32, 0_usize);
        let integer_start = self.at;
        while let Some(digit @ b'0'..=b'9') = self.peek() {
            if mantissa < 1_000_000_000_000_000_000 {
                mantissa = mantissa * 10 + u64::from(digit - b'0');
            } else {
                exponent = exponent.saturating_add(1);
            }
            self.at += 1;
        }
        digits += self.at - integer_start;
        if self.peek() == Some(b'.') {
            self.at += 1;
            let fraction_start = self.at;
            while let Some(digit @ b'0'..=b'9') = self.peek() {
                if mantissa < 1_000_000_000_000_000_000 {
                    mantissa = mantissa * 10 + u64::from(digit - b'0');
                    exponent = exponent.saturating_sub(1);
                }
                self.at += 1;
            }
            digits += self.at - fraction_start;
        }
        if digits == 0 {
            return None;
        }
        if let Some(b'e' | b'E') = self.peek() {
            self.at += 1;
            let minus = self.peek() == Some(b'-');
            if minus || self.peek() == Some(b'+') {
                self.at += 1;
            }
            let (start, mut written) = (self.at, 0_i32);
            while let Some(digit @ b'0'..=b'9') = self.peek() {
                written = written.saturating_mul(10).saturating_add(i32::from(digit - b'0'));
                self.at += 1;
            }
            if self.at == start {
                return None;
            }
            exponent = exponent.saturating_add(if minus { -written } else { written });
        }
        let magnitude = to_nearest_f32(mantissa, exponent)?;
        Some(if negative { -magnitude } else { magnitude })
    }

    /// The next word's leading integer as an index from 0 in a list of `count` elements so far.
    /// A positive one may lie beyond `count`: the element may follow later in the file.
    #[inline]
    pub(super) fn index(&mut self, count: usize) -> Result<u32, Fault> {
        let negative = self.peek() == Some(b'-');
        if negative || self.peek() == Some(b'+') {
            self.at += 1;
        }
        let (start, mut value) = (self.at, 0_usize);
        while let Some(digit @ b'0'..=b'9') = self.peek() {
            value = value.saturating_mul(10).saturating_add(usize::from(digit - b'0'));
            self.at += 1;
        }
        if self.at == start {
            return Err(if self.is_at_word_end() { Fault::Missing } else { Fault::NotANumber });
        }
        let index = if negative { count.checked_sub(value) } else { value.checked_sub(1) };
        match index.map(u32::try_from) {
            // `-0` would be the element that comes next.
            Some(Ok(index)) if index < u32::MAX && value > 0 => Ok(index),
            _ => Err(Fault::OutOfRange),
        }
    }

    /// Steps over a `/` between the parts of a corner; whether there was one.
    #[inline]
    pub(super) fn skip_slash(&mut self) -> bool {
        let found = self.peek() == Some(b'/');
        self.at += usize::from(found);
        found
    }

    /// Whether an index follows and not the next `/` or the end of the corner.
    #[inline]
    pub(super) fn has_index(&self) -> bool {
        !self.is_at_word_end() && self.peek() != Some(b'/')
    }

    /// Whether the corner that was being read is over.
    #[inline]
    pub(super) fn is_at_corner_end(&self) -> bool {
        self.is_at_word_end()
    }
}

/// Powers of ten that `f64` holds exactly.
const POWERS_OF_TEN: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

/// `mantissa · 10^exponent` rounded to the nearest `f32`, or `None` where that is not certain.
///
/// The `f64` product is off by less than 2 units in its last place (one rounding of the
/// mantissa, one of the product, dropped digits below 10⁻¹⁸). A midpoint between two `f32` has
/// the low 29 bits 1000…0; four units away from that, rounding again cannot go wrong.
#[inline]
fn to_nearest_f32(mantissa: u64, exponent: i32) -> Option<f32> {
    if mantissa == 0 {
        return Some(0.0);
    }
    let power = *POWERS_OF_TEN.get(exponent.unsigned_abs() as usize)?;
    #[allow(clippy::cast_precision_loss)] // counted in the margin
    let value = if exponent < 0 { mantissa as f64 / power } else { mantissa as f64 * power };
    let is_normal = (f64::from(f32::MIN_POSITIVE)..=f64::from(f32::MAX)).contains(&value);
    let from_midpoint = (value.to_bits() & 0x1FFF_FFFF).abs_diff(0x1000_0000);
    #[allow(clippy::cast_possible_truncation)] // rounding is what is wanted
    (is_normal && from_midpoint > 4).then_some(value as f32)
}

/// Any spelling the standard library reads, and the reason where it reads none.
#[cold]
fn parse_slowly(word: &[u8]) -> Result<f32, Fault> {
    let text = String::from_utf8_lossy(word);
    match text.parse::<f32>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(Fault::NotFinite),
        Err(_) if is_not_finite_word(word) => Err(Fault::NotFinite),
        // `-`, `1e`, `1e-`: one more digit would make it a number.
        Err(_) if format!("{text}0").parse::<f32>().is_ok() => Err(Fault::Missing),
        Err(_) => Err(Fault::NotANumber),
    }
}

/// `nan(…)`, `-nan`, `1.#QNAN`, `-1.#IND`: what C libraries print for numbers that are none.
fn is_not_finite_word(word: &[u8]) -> bool {
    let unsigned = word.strip_prefix(b"-").or_else(|| word.strip_prefix(b"+")).unwrap_or(word);
    let begins = |start: &[u8]| unsigned.len() >= start.len() && unsigned[..start.len()].eq_ignore_ascii_case(start);
    begins(b"nan") || begins(b"inf") || begins(b"1.#")
}

/// Whether `word` begins as a number does, finite or not.
pub(super) fn looks_like_number(word: &[u8]) -> bool {
    let unsigned = word.strip_prefix(b"-").or_else(|| word.strip_prefix(b"+")).unwrap_or(word);
    let digits = unsigned.strip_prefix(b".").unwrap_or(unsigned);
    digits.first().is_some_and(u8::is_ascii_digit) || is_not_finite_word(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(text: &str) -> Result<f32, Fault> {
        Scanner::new(text.as_bytes()).number()
    }

    #[test]
    fn numbers_equal_the_standard_library_bit_for_bit() {
        let mut state = 0x2545_F491_4F6C_DD1D_u64;
        let mut next = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            state
        };
        for round in 0..400_000 {
            let text = match round % 6 {
                0 => format!("{}", f32::from_bits(next() as u32)),
                1 => format!("{:e}", f64::from_bits(next())),
                2 => format!("{}.{}", next() as i32, next() % 1_000_000),
                // Midpoints between two f32, exactly and just beside.
                3 => {
                    let low = f32::from_bits(0x3000_0000 + (next() as u32 >> 3));
                    let middle = (f64::from(low) + f64::from(f32::from_bits(low.to_bits() + 1))) / 2.0;
                    format!("{middle}{}", ["", "0", "1", "0000000000000000000000000001"][next() as usize % 4])
                }
                4 => format!("{}e{}", next(), next() % 60),
                _ => format!("-0.{:0>9}E-{}", next() % 1_000_000_000, next() % 45),
            };
            let expected = text.parse::<f32>().unwrap();
            match number(&text) {
                Ok(value) => assert_eq!(value.to_bits(), expected.to_bits(), "{text}"),
                Err(fault) => assert!(fault == Fault::NotFinite && !expected.is_finite(), "{text} {fault:?}"),
            }
        }
    }

    #[test]
    fn odd_spellings() {
        for (text, value) in [("1.", 1.0), (".5", 0.5), ("+.5e+2", 50.0), ("1e010", 1e10), ("000012", 12.0)] {
            assert_eq!(number(text), Ok(value), "{text}");
        }
        assert_eq!(number("-0").unwrap().to_bits(), (-0.0_f32).to_bits());
        for text in ["abc", "1,5", "--1", "3.1+e2", "0x10", "1.2.3", "\u{FF11}"] {
            assert_eq!(number(text), Err(Fault::NotANumber), "{text}");
        }
        for text in ["nan", "-nan(ind)", "Inf", "+infinity", "1.#QNAN", "-1.#IND", "1e39", "1e999999999999"] {
            assert_eq!(number(text), Err(Fault::NotFinite), "{text}");
        }
        for text in ["  # 1", "", "1e", ".", "-", "+1.5e-"] {
            assert_eq!(number(text), Err(Fault::Missing), "{text}");
        }
    }
}
