//! Why Embree cannot be used, and what to do about it.

use thiserror::Error;

/// The environment variable that names the library to load instead of the usual ones.
pub(super) const OVERRIDE: &str = "EMBREE_LIB";

/// Why Embree cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum EmbreeError {
    /// No library can be used.
    #[error(
        "Embree cannot be loaded ({}): install it with `apt install libembree4-4` or, on older \
         systems, `apt install libembree3-3`, or set {OVERRIDE} to the path of the library",
        .tried.join("; ")
    )]
    Missing {
        /// What is wrong with each name tried.
        tried: Vec<String>,
    },
    /// The library lacks a function.
    #[error("{library} has no function {symbol}: is it Embree 3 or 4?")]
    Symbol {
        /// The library opened.
        library: String,
        /// The function looked for.
        symbol: String,
    },
    /// The library is an Embree of another major version.
    #[error("{library} is Embree {major}, but version 3 or 4 is needed")]
    Version {
        /// The library opened.
        library: String,
        /// The major version it reports.
        major: isize,
    },
    /// Embree refused a request.
    #[error("Embree could not {request}: {}", error_name(*.code))]
    Refused {
        /// What was asked for.
        request: &'static str,
        /// The `RTCError` reported.
        code: i32,
    },
}

/// Opens the first usable library of a list. An installed library may not suit the processor, while
/// an older one does.
///
/// # Errors
/// When none opens; the error says what is wrong with each.
pub(super) fn first_usable<T>(
    names: &[&str],
    open: impl Fn(&str) -> Result<T, EmbreeError>,
) -> Result<T, EmbreeError> {
    let mut tried = Vec::new();
    for name in names {
        match open(name) {
            Ok(library) => return Ok(library),
            Err(EmbreeError::Missing { tried: said }) => tried.extend(said),
            Err(error @ EmbreeError::Refused { .. }) => tried.push(format!("{name}: {error}")),
            Err(error) => tried.push(error.to_string()), // it names the library
        }
    }
    Err(EmbreeError::Missing { tried })
}

/// What the numbers of `RTCError` mean.
fn error_name(code: i32) -> String {
    match code {
        2 => "invalid argument".into(),
        3 => "invalid operation".into(),
        4 => "out of memory".into(),
        5 => "unsupported processor".into(),
        6 => "cancelled".into(),
        other => format!("error {other}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_library_says_how_to_install_one() {
        let error = EmbreeError::Missing { tried: vec!["a: no".into(), "b: no".into()] };
        assert_eq!(
            error.to_string(),
            "Embree cannot be loaded (a: no; b: no): install it with `apt install libembree4-4` \
             or, on older systems, `apt install libembree3-3`, or set EMBREE_LIB to the path of \
             the library"
        );
    }

    #[test]
    fn the_next_library_is_tried_where_one_refuses() {
        let open = |name: &str| match name {
            "none" => Err(EmbreeError::Missing { tried: vec!["none: no such file".into()] }),
            "new" => Err(EmbreeError::Refused { request: "open a device", code: 5 }),
            "old" => Err(EmbreeError::Version { library: "old".into(), major: 2 }),
            name => Ok(name.to_owned()),
        };
        assert_eq!(first_usable(&["none", "new", "good", "old"], open), Ok("good".to_owned()));
        let tried = [
            "none: no such file",
            "new: Embree could not open a device: unsupported processor",
            "old is Embree 2, but version 3 or 4 is needed",
        ];
        assert_eq!(
            first_usable(&["none", "new", "old"], open),
            Err(EmbreeError::Missing { tried: tried.map(String::from).to_vec() })
        );
    }

    #[test]
    fn refusals_name_request_and_reason() {
        let error = EmbreeError::Refused { request: "build a scene", code: 4 };
        assert_eq!(error.to_string(), "Embree could not build a scene: out of memory");
    }
}
