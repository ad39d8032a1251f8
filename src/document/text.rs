//! The bytes of a text format: lines of numbers and names, formatted without allocation.

/// Grows by whole lines.
pub(super) struct Text {
    bytes: Vec<u8>,
    float: zmij::Buffer,
    integer: itoa::Buffer,
}

impl Text {
    /// Empty, with room for `capacity` bytes.
    pub(super) fn with_capacity(capacity: usize) -> Self {
        Self { bytes: Vec::with_capacity(capacity), float: zmij::Buffer::new(), integer: itoa::Buffer::new() }
    }

    /// All that was written.
    pub(super) fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// A line of a keyword and a name, which is made one line: control characters become blanks,
    /// and a blank keeps a backslash at its end from continuing the line.
    pub(super) fn line(&mut self, keyword: &str, name: &str) {
        self.bytes.extend_from_slice(keyword.as_bytes());
        let name = name.trim_matches(|c: char| c == ' ' || c.is_ascii_control());
        if !name.is_empty() {
            self.bytes.push(b' ');
            self.bytes.extend(name.bytes().map(|byte| if byte.is_ascii_control() { b' ' } else { byte }));
            if name.ends_with('\\') {
                self.bytes.push(b' ');
            }
        }
        self.end_line();
    }

    /// A keyword and numbers; the line stays open.
    pub(super) fn numbers(&mut self, keyword: &str, values: &[f32]) {
        self.bytes.extend_from_slice(keyword.as_bytes());
        self.more_numbers(values);
    }

    /// Further numbers in the open line, each as the shortest text that reads back the same.
    #[inline(never)]
    pub(super) fn more_numbers(&mut self, values: &[f32]) {
        for &value in values {
            let digits = self.float.format_finite(value);
            self.bytes.push(b' ');
            self.bytes.extend_from_slice(digits.strip_suffix(".0").unwrap_or(digits).as_bytes());
        }
    }

    /// Numbers at the start of a line; the line stays open.
    pub(super) fn first_numbers(&mut self, values: &[f32]) {
        let start = self.bytes.len();
        self.more_numbers(values);
        // The blank before the first.
        self.bytes.remove(start);
    }

    /// As [`Text::more_numbers`], with a point or an exponent in each.
    pub(super) fn more_decimals(&mut self, values: &[f32]) {
        for &value in values {
            self.bytes.push(b' ');
            self.bytes.extend_from_slice(self.float.format_finite(value).as_bytes());
        }
    }

    /// A line of a keyword and three indices.
    #[inline]
    pub(super) fn indices(&mut self, keyword: &str, indices: [usize; 3]) {
        self.bytes.extend_from_slice(keyword.as_bytes());
        for index in indices {
            self.bytes.push(b' ');
            self.index(index);
        }
        self.end_line();
    }

    /// Ends the open line.
    pub(super) fn end_line(&mut self) {
        self.bytes.push(b'\n');
    }

    /// An `f` line of corners `[v, vt, vn]`, with `vt` and `vn` as `form` asks.
    #[inline]
    pub(super) fn face(&mut self, corners: [[usize; 3]; 3], form: [bool; 2]) {
        self.bytes.push(b'f');
        for [v, vt, vn] in corners {
            self.bytes.push(b' ');
            self.index(v);
            if form != [false; 2] {
                self.bytes.push(b'/');
            }
            if form[0] {
                self.index(vt);
            }
            if form[1] {
                self.bytes.push(b'/');
                self.index(vn);
            }
        }
        self.end_line();
    }

    #[inline]
    fn index(&mut self, index: usize) {
        self.bytes.extend_from_slice(self.integer.format(index).as_bytes());
    }
}
