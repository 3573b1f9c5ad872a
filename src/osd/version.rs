//! Which OpenSubdiv is in use.

use super::raw;
use std::ffi::CStr;
use std::fmt;

/// A version of OpenSubdiv.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Version {
    /// First number.
    pub major: u32,
    /// Second number.
    pub minor: u32,
    /// Third number.
    pub patch: u32,
}

impl Version {
    /// A version by its three numbers.
    pub const fn new(major: u32, minor: u32, patch: u32) -> Self {
        Self { major, minor, patch }
    }
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}.{}", self.major, self.minor, self.patch)
    }
}

/// The version that is in use. It is that of the headers which the shim was compiled with; the dynamic linker looks for a library
/// of just this version, because OpenSubdiv's libraries carry all three numbers in their names.
pub fn version() -> Version {
    // SAFETY: osd_version returns a static C string.
    let text = unsafe { CStr::from_ptr(raw::osd_version()) }.to_string_lossy();
    let mut numbers = text.split('.').map(|number| number.parse().unwrap_or(0));
    let mut next = || numbers.next().unwrap_or(0);
    Version::new(next(), next(), next())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_ordered_and_shown_as_usual() {
        assert!(Version::new(3, 5, 1) < Version::new(3, 6, 0) && Version::new(3, 10, 0) > Version::new(3, 6, 1));
        assert_eq!(Version::new(3, 6, 0).to_string(), "3.6.0");
        assert!((Version::new(3, 5, 0)..Version::new(4, 0, 0)).contains(&version()), "{}", version());
    }
}
