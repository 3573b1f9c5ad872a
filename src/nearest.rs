//! What somebody may have meant who misspelt a name.

/// Least likeness (Jaro's, 0 to 1) of a name that is suggested: a letter too many, too few or swapped is above it, another word below.
const LEAST: f64 = 0.75;

/// The name that is most like a word, if one is like it.
pub(crate) fn nearest<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    let likeness = names.into_iter().map(|name| (strsim::jaro(&word, &name.to_lowercase()), name));
    likeness.filter(|(like, _)| *like >= LEAST).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn misspelt_names_are_found_and_others_are_not() {
        let names = ["stripes", "lattice", "circles", "band", "heat"];
        for (word, name) in [("strips", "stripes"), ("latice", "lattice"), ("CIRCLE", "circles"), ("haet", "heat")] {
            assert_eq!(nearest(word, names), Some(name));
        }
        for word in ["", "x", "nosuch", "reflection"] {
            assert_eq!(nearest(word, names), None, "{word}");
        }
    }
}
