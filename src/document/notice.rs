//! What reading leaves out or changes: one warning for each kind, with a count and the first place.

use crate::error::Warning;

/// The kinds met so far, in the order they were met.
#[derive(Debug, Default)]
pub(super) struct Notices {
    met: Vec<Notice>,
}

#[derive(Debug)]
struct Notice {
    code: &'static str,
    text: &'static str,
    count: usize,
    first: String,
}

impl Notices {
    /// Notes one more of a kind. The count goes before `text` in the warning.
    #[inline(never)]
    pub(super) fn count(&mut self, code: &'static str, text: &'static str, place: &dyn Fn() -> String) {
        match self.met.iter_mut().find(|notice| notice.code == code) {
            Some(notice) => notice.count += 1,
            None => self.met.push(Notice { code, text, count: 1, first: place() }),
        }
    }

    /// The warnings.
    pub(super) fn into_warnings(self) -> Vec<Warning> {
        let warning = |notice: Notice| Warning {
            code: notice.code,
            message: format!("{} {}", notice.count, notice.text),
            place: notice.first,
        };
        self.met.into_iter().map(warning).collect()
    }
}
