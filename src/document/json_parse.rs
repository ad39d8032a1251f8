//! Reads a JSON text (RFC 8259) into a tree; nothing that is not JSON gets through, and no nesting is too deep for the stack.

use std::str::from_utf8;

use super::json_tree::{Members, Value};

/// Lists and objects within each other, at most.
const MOST_NESTED: usize = 128;

/// Why a text is no JSON.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Fault {
    /// The byte where it was noticed.
    pub(crate) at: usize,
    pub(crate) message: &'static str,
    /// The text ends too soon.
    pub(crate) is_end: bool,
}

/// The tree of a whole text; white space may surround it.
///
/// # Errors
/// The first [`Fault`].
pub(crate) fn parse(json: &[u8]) -> Result<Value, Fault> {
    if let Err(error) = from_utf8(json) {
        return Err(Fault { at: error.valid_up_to(), message: "not UTF-8", is_end: false });
    }
    let mut parser = Parser { json, at: 0, nested: 0, values: Vec::new(), members: Vec::new() };
    let value = parser.value()?;
    parser.skip_space();
    if parser.at < json.len() { parser.fail("something follows the end of the value") } else { Ok(value) }
}

/// What is in `all` from `first` on, in no more memory than it takes, and none beside that even where it is all.
fn split_off<T>(all: &mut Vec<T>, first: usize) -> Vec<T> {
    if first > 0 {
        return all.split_off(first);
    }
    let mut whole = std::mem::take(all);
    whole.shrink_to_fit();
    whole
}

struct Parser<'j> {
    json: &'j [u8],
    at: usize,
    nested: usize,
    /// Elements and members of what is open, inner ones at the end, until their number is known.
    values: Vec<Value>,
    members: Vec<(Box<str>, Value)>,
}

impl<'j> Parser<'j> {
    #[cold]
    #[inline(never)]
    fn fail<T>(&self, message: &'static str) -> Result<T, Fault> {
        let is_end = self.at >= self.json.len();
        Err(Fault { at: self.at, message: if is_end { "the text ends too soon" } else { message }, is_end })
    }

    fn peek(&self) -> u8 {
        // No value begins with 0, nor ends.
        self.json.get(self.at).copied().unwrap_or(0)
    }

    fn skip_space(&mut self) {
        while matches!(self.peek(), b' ' | b'\n' | b'\r' | b'\t') {
            self.at += 1;
        }
    }

    fn value(&mut self) -> Result<Value, Fault> {
        self.skip_space();
        match self.peek() {
            b'"' => Ok(Value::String(self.string()?)),
            b'{' => self.nest(Self::object),
            b'[' => self.nest(Self::array),
            b'-' | b'0'..=b'9' => self.number(),
            b't' => self.word(b"true", Value::Bool(true)),
            b'f' => self.word(b"false", Value::Bool(false)),
            b'n' => self.word(b"null", Value::Null),
            _ => self.fail("expected a value"),
        }
    }

    fn word(&mut self, word: &'static [u8], value: Value) -> Result<Value, Fault> {
        for &letter in word {
            if self.peek() != letter {
                return self.fail("expected a value");
            }
            self.at += 1;
        }
        Ok(value)
    }

    fn nest(&mut self, read: fn(&mut Self) -> Result<Value, Fault>) -> Result<Value, Fault> {
        if self.nested == MOST_NESTED {
            return self.fail("nested too deeply");
        }
        self.nested += 1;
        self.at += 1;
        let value = read(self);
        self.nested -= 1;
        value
    }

    fn array(&mut self) -> Result<Value, Fault> {
        let first = self.values.len();
        self.skip_space();
        if self.peek() != b']' {
            loop {
                let value = self.value()?;
                self.values.push(value);
                if !self.goes_on(b']', "expected `,` or `]`")? {
                    break;
                }
            }
        }
        self.at += 1;
        Ok(Value::Array(split_off(&mut self.values, first)))
    }

    fn object(&mut self) -> Result<Value, Fault> {
        let first = self.members.len();
        self.skip_space();
        if self.peek() != b'}' {
            loop {
                self.skip_space();
                if self.peek() != b'"' {
                    return self.fail("expected a key in quotes");
                }
                let key = self.string()?;
                self.skip_space();
                if self.peek() != b':' {
                    return self.fail("expected `:`");
                }
                self.at += 1;
                let value = self.value()?;
                self.members.push((key, value));
                if !self.goes_on(b'}', "expected `,` or `}`")? {
                    break;
                }
            }
        }
        self.at += 1;
        Ok(Value::Object(Members::of(split_off(&mut self.members, first))))
    }

    /// Whether a comma follows, and not the end of the list, which is left where it is.
    fn goes_on(&mut self, end: u8, message: &'static str) -> Result<bool, Fault> {
        self.skip_space();
        match self.peek() {
            b',' => {
                self.at += 1;
                Ok(true)
            }
            byte if byte == end => Ok(false),
            _ => self.fail(message),
        }
    }

    fn digits(&mut self) -> Result<(), Fault> {
        if !self.peek().is_ascii_digit() {
            return self.fail("expected a digit");
        }
        while self.peek().is_ascii_digit() {
            self.at += 1;
        }
        Ok(())
    }

    fn number(&mut self) -> Result<Value, Fault> {
        let start = self.at;
        let mut is_whole = true;
        if self.peek() == b'-' {
            is_whole = false;
            self.at += 1;
        }
        if self.peek() == b'0' {
            self.at += 1;
            if self.peek().is_ascii_digit() {
                return self.fail("a number has no zeros before it");
            }
        } else {
            self.digits()?;
        }
        if self.peek() == b'.' {
            is_whole = false;
            self.at += 1;
            self.digits()?;
        }
        if matches!(self.peek(), b'e' | b'E') {
            is_whole = false;
            self.at += 1;
            if matches!(self.peek(), b'+' | b'-') {
                self.at += 1;
            }
            self.digits()?;
        }
        let digits = &self.json[start..self.at];
        // 19 digits are below 2^64.
        if is_whole && digits.len() <= 19 {
            return Ok(Value::Whole(digits.iter().fold(0, |number, digit| number * 10 + u64::from(digit - b'0'))));
        }
        let text = self.text(start);
        Ok(text.parse().ok().filter(|_| is_whole).map_or_else(|| Value::Number(text.into()), Value::Whole))
    }

    /// From a byte, the first of a character, to here.
    fn text(&self, start: usize) -> &'j str {
        // All of it is UTF-8, and all marks are ASCII.
        from_utf8(&self.json[start..self.at]).unwrap_or_default()
    }

    /// A string, from its first quote to behind its last.
    fn string(&mut self) -> Result<Box<str>, Fault> {
        self.at += 1;
        let start = self.at;
        self.skip_plain();
        if self.peek() == b'"' {
            let text = self.text(start).into();
            self.at += 1;
            return Ok(text);
        }
        let mut out = self.text(start).to_owned();
        while self.peek() != b'"' {
            if self.peek() != b'\\' {
                return self.fail("a string has no control characters");
            }
            self.at += 1;
            out.push(self.escaped()?);
            let start = self.at;
            self.skip_plain();
            out.push_str(self.text(start));
        }
        self.at += 1;
        Ok(out.into())
    }

    fn skip_plain(&mut self) {
        while !matches!(self.peek(), 0..32 | b'"' | b'\\') {
            self.at += 1;
        }
    }

    /// What follows a backslash.
    #[inline(never)]
    fn escaped(&mut self) -> Result<char, Fault> {
        let escaped = match self.peek() {
            byte @ (b'"' | b'\\' | b'/') => byte.into(),
            b'b' => '\u{8}',
            b'f' => '\u{c}',
            b'n' => '\n',
            b'r' => '\r',
            b't' => '\t',
            b'u' => {
                self.at += 1;
                return self.code_point();
            }
            _ => return self.fail("no such escape"),
        };
        self.at += 1;
        Ok(escaped)
    }

    /// The digits after `\u`, and the second half of a pair (RFC 8259, section 7).
    fn code_point(&mut self) -> Result<char, Fault> {
        let mut unit = self.unit()?;
        if (0xD800..0xDC00).contains(&unit) && self.json[self.at..].starts_with(b"\\u") {
            self.at += 2;
            let low = self.unit()?;
            if (0xDC00..0xE000).contains(&low) {
                unit = 0x1_0000 + ((unit - 0xD800) << 10) + (low - 0xDC00);
            }
        }
        char::from_u32(unit).map_or_else(|| self.fail("half of a surrogate pair"), Ok)
    }

    fn unit(&mut self) -> Result<u32, Fault> {
        let mut unit = 0;
        for _ in 0..4 {
            let Some(digit) = char::from(self.peek()).to_digit(16) else {
                return self.fail("expected four hexadecimal digits");
            };
            unit = unit * 16 + digit;
            self.at += 1;
        }
        Ok(unit)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]

    use proptest::prelude::*;

    use super::*;

    /// As a library reads it, whose numbers keep their digits too.
    fn agrees(text: &[u8]) -> Result<(), TestCaseError> {
        let theirs = serde_json::from_slice::<serde_json::Value>(text);
        match (parse(text), theirs) {
            (Ok(ours), Ok(theirs)) => {
                let mut out = Vec::new();
                ours.write(&mut out);
                // Theirs writes some exponents otherwise than they were.
                prop_assert_eq!(serde_json::from_slice::<serde_json::Value>(&out).ok(), Some(theirs));
            }
            (ours, theirs) => prop_assert_eq!(ours.is_ok(), theirs.is_ok(), "{:?}", String::from_utf8_lossy(text)),
        }
        Ok(())
    }

    #[test]
    fn agrees_with_a_library_on_what_is_json_and_what_it_says() {
        let digits = "18446744073709551615 18446744073709551616 9999999999999999999 0 -0 1.0 1e5 1E+5 1e-05 -1.50";
        for number in digits.split(' ') {
            agrees(number.as_bytes()).unwrap();
            let mut out = Vec::new();
            parse(number.as_bytes()).unwrap().write(&mut out);
            assert_eq!(String::from_utf8(out).unwrap(), number);
        }
        for text in [
            r#"{"a":1,"b":{"a":[]},"a":[true,false,null]}"#,
            r#""\ud83d\ude00 \u00e9 \/ \b\f\n\r\t\"\\ \u0001 ""#,
            r#""\ud83d""#,
            r#""\ud83dx""#,
            r#""\ud83d\u0041""#,
            r#""\ude00""#,
            r#""\x""#,
            "\"\n\"",
            "\u{feff}1",
            "01",
            "-",
            "1.",
            ".5",
            "1e",
            "+1",
            "[1,]",
            "{\"a\":1,}",
            "{a:1}",
            "[1 2]",
            "[",
            "{\"a\"",
            "nul",
            "nullx",
            "1 1",
            " \t\r\n1\n",
            "",
            "\u{a0}1",
        ] {
            agrees(text.as_bytes()).unwrap();
        }
        agrees(b"\"\xff\"").unwrap();
        agrees(b"[0]\0").unwrap();
        for depth in [126, 127, 129, 1_000_000] {
            agrees(&[vec![b'['; depth], vec![b']'; depth]].concat()).unwrap();
        }
    }

    #[test]
    fn says_where_a_text_goes_wrong_or_ends() {
        assert_eq!(parse(b"[1, x]"), Err(Fault { at: 4, message: "expected a value", is_end: false }));
        assert_eq!(parse(b"[1, "), Err(Fault { at: 4, message: "the text ends too soon", is_end: true }));
        assert_eq!(parse(b"{\"a\" 1}"), Err(Fault { at: 5, message: "expected `:`", is_end: false }));
    }

    #[test]
    fn keeps_the_last_of_a_repeated_key_in_the_place_of_the_first_however_many_there_are() {
        for count in [3, 16, 17, 40] {
            let members: Vec<String> =
                (0..count).chain([1, 1, count - 1]).enumerate().map(|(i, n)| format!("\"k{n}\":{i}")).collect();
            agrees(format!("{{{}}}", members.join(",")).as_bytes()).unwrap();
        }
    }

    proptest! {
        #[test]
        fn agrees_on_texts_that_are_nearly_json(text in r#"[\[\]{}",:0-9.eE+\-truefalsn \\/bu\x00-\x1f]{0,24}"#) {
            agrees(text.as_bytes())?;
        }

        #[test]
        fn agrees_on_any_bytes_within_quotes(inner in proptest::collection::vec(any::<u8>(), 0..12)) {
            agrees(&[b"\"", &inner[..], b"\""].concat())?;
        }
    }
}
