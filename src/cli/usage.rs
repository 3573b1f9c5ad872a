//! What is wrong with the arguments, in one line that ends in the help to look at.

use super::args::Cli;
use crate::nearest::nearest;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Command, CommandFactory, Error};
use std::error::Error as _;
use std::ffi::OsString;

/// Names of the commands, without those that are hidden.
pub(super) fn commands() -> Vec<String> {
    let command = Cli::command();
    let shown = command.get_subcommands().filter(|command| !command.is_hide_set());
    shown.map(|command| command.get_name().to_owned()).collect()
}

/// What clap found, in our words; `args` are those of the process, its name first.
pub(super) fn line(error: &Error, args: &[OsString]) -> String {
    let mut all = Cli::command();
    // Only then arguments can be shown.
    all.build();
    let words: Vec<&str> = args.iter().skip(1).filter_map(|arg| arg.to_str()).collect();
    let of = words.iter().filter(|word| **word != "help").find_map(|word| all.find_subcommand(word));
    let help = of.map_or_else(|| "catoptric --help".to_owned(), |of| format!("catoptric {} --help", of.get_name()));
    let found = Found { error, all: &all, of, words };
    let what = found.what().unwrap_or_else(|| plain(error));
    // A question ends its sentence; what follows begins one.
    match what.ends_with('?') {
        true => format!("{what} See {help}"),
        false => format!("{what}; see {help}"),
    }
}

/// What clap itself says, without the usage that it puts below.
fn plain(error: &Error) -> String {
    let text = error.to_string();
    let lines: Vec<&str> = text.lines().map(str::trim).take_while(|line| !line.is_empty()).collect();
    lines.join(" ").trim_start_matches("error: ").to_owned()
}

/// An error, and whose arguments it is about.
struct Found<'a> {
    error: &'a Error,
    all: &'a Command,
    of: Option<&'a Command>,
    /// The arguments, as far as they are text.
    words: Vec<&'a str>,
}

impl Found<'_> {
    fn text(&self, kind: ContextKind) -> Option<&str> {
        match self.error.get(kind)? {
            ContextValue::String(text) => Some(text),
            _ => None,
        }
    }

    fn texts(&self, kind: ContextKind) -> Vec<&str> {
        match self.error.get(kind) {
            Some(ContextValue::Strings(texts)) => texts.iter().map(String::as_str).collect(),
            Some(ContextValue::String(text)) => vec![text],
            _ => Vec::new(),
        }
    }

    /// `None` where clap says it well enough.
    fn what(&self) -> Option<String> {
        match self.error.kind() {
            ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand | ErrorKind::MissingSubcommand => {
                Some(format!("no command; give {}", either(&commands())))
            }
            ErrorKind::InvalidSubcommand => Some(self.unknown_command(self.text(ContextKind::InvalidSubcommand)?)),
            ErrorKind::UnknownArgument => Some(self.unknown_argument(self.text(ContextKind::InvalidArg)?)),
            ErrorKind::InvalidValue => self.value_of_list(),
            ErrorKind::ValueValidation => {
                let [flag, value] = [ContextKind::InvalidArg, ContextKind::InvalidValue].map(|kind| self.text(kind));
                let problem = self.error.source().map(ToString::to_string)?;
                Some(format!("{} {}: {}", flag_of(flag?), value?, in_words(&problem)))
            }
            ErrorKind::MissingRequiredArgument => {
                let missing = self.texts(ContextKind::InvalidArg);
                let name = self.of.map_or("catoptric", |of| of.get_name());
                // What `requires` asks for, rather than the command.
                let given = missing.iter().all(|arg| !self.is_required(arg));
                let name = if given { "what is given" } else { name };
                Some(format!("{name} needs {}; add it", missing.join(" and ")))
            }
            ErrorKind::ArgumentConflict => {
                let flag = flag_of(self.text(ContextKind::InvalidArg)?);
                let prior = self.texts(ContextKind::PriorArg);
                let prior: Vec<String> = prior.into_iter().map(|arg| flag_of(arg).to_owned()).collect();
                if prior.iter().any(|other| other == flag) || prior.is_empty() {
                    return Some(format!("{flag} is given twice; give it once"));
                }
                Some(format!("{flag} does not go with {}; leave one of them out", prior.join(", ")))
            }
            ErrorKind::InvalidUtf8 => Some("an argument is not UTF-8, where only file names need not be".to_owned()),
            _ => None,
        }
    }

    /// Whether the command does not go without an argument.
    fn is_required(&self, shown: &str) -> bool {
        let mut args = self.of.into_iter().flat_map(|of| of.get_arguments());
        args.any(|arg| arg.is_required_set() && flag_of(&arg.to_string()) == flag_of(shown))
    }

    fn unknown_command(&self, word: &str) -> String {
        let names = commands();
        match nearest(word, names.iter().map(String::as_str)) {
            Some(name) => format!("no command '{word}'; did you mean {name}?"),
            None => format!("no command '{word}'; give {}", either(&names)),
        }
    }

    fn unknown_argument(&self, found: &str) -> String {
        let whose = self.of.map_or("catoptric", |of| of.get_name());
        if !found.starts_with('-') {
            return format!("{whose} has no use for '{found}': every argument that it takes is there already");
        }
        // Of letters after one dash clap names the first.
        let at = self.words.iter().position(|word| word.starts_with(found)).unwrap_or(0);
        let word = self.words.get(at).map_or(found, |word| flag_of(word));
        if word[1..].starts_with(|c: char| c.is_ascii_digit() || c == '.') && at > 0 {
            let before = self.words[at - 1];
            return format!("{word} begins as an option does; if it is meant for {before}, write {before}={word}");
        }
        let name = word.trim_start_matches('-');
        let longs: Vec<&str> = self.of.unwrap_or(self.all).get_arguments().filter_map(|arg| arg.get_long()).collect();
        // One dash may be one too few.
        let of_two = longs.contains(&name).then_some(name);
        let others = self
            .all
            .get_subcommands()
            .filter(|other| !other.is_hide_set() && other.get_arguments().any(|arg| arg.get_long() == Some(name)));
        let others: Vec<&str> = others.map(Command::get_name).collect();
        match (of_two.or_else(|| nearest(name, longs.iter().copied())), self.of) {
            (_, None) if !others.is_empty() => {
                format!("{word} is an option of {}; write it after the command", others.join(", "))
            }
            (Some(near), _) => format!("{whose} has no option {word}; did you mean --{near}?"),
            (None, _) if !others.is_empty() => {
                format!("{whose} has no option {word}, which is one of {}; leave it out", others.join(", "))
            }
            (None, _) => format!("{whose} has no option {word}; leave it out"),
        }
    }

    /// A value that is missing, or none of those that there are.
    fn value_of_list(&self) -> Option<String> {
        let arg = self.text(ContextKind::InvalidArg)?;
        let (flag, value) = (flag_of(arg), self.text(ContextKind::InvalidValue)?);
        let values = self.texts(ContextKind::ValidValue);
        let list = (!values.is_empty()).then(|| either(&values));
        Some(match (value, list) {
            ("", None) => format!("{flag} needs a value; write {arg}"),
            ("", Some(list)) => format!("{flag} needs a value; give {list}"),
            (_, Some(list)) => {
                let near = nearest(value, values.iter().copied());
                let near = near.map(|near| format!(" (did you mean {near}?)")).unwrap_or_default();
                format!("{flag} has no value '{value}'{near}; give {list}")
            }
            (_, None) => return None,
        })
    }
}

/// `--size` of `--size <WxH>`, `MESH` of `[MESH]`.
fn flag_of(shown: &str) -> &str {
    shown.split([' ', '=']).next().unwrap_or(shown).trim_matches(['<', '>', '[', ']', '.'])
}

/// Names with commas, and `or` before the last.
fn either(names: &[impl AsRef<str>]) -> String {
    let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    match names.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => names.concat(),
    }
}

/// What parsers of numbers say, for people.
fn in_words(problem: &str) -> String {
    if let Some((low, high)) = problem.split_once(" is not in ").and_then(|(_, range)| range.split_once("..=")) {
        return format!("give a whole number from {low} to {high}");
    }
    match problem {
        "invalid digit found in string" | "cannot parse integer from empty string" => "give a whole number".to_owned(),
        "number too large to fit in target type" => "give a smaller number".to_owned(),
        "number too small to fit in target type" => "give a larger number".to_owned(),
        problem => problem.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    fn said(words: &str) -> String {
        let args: Vec<OsString> =
            std::iter::once("catoptric").chain(words.split_whitespace()).map(Into::into).collect();
        match Cli::try_parse_from(&args) {
            Ok(_) => panic!("{words} is fine"),
            Err(error) => line(&error, &args),
        }
    }

    /// What tests/cli/usage.rs asks the program, of clap's kinds that flags of today do not have.
    #[test]
    fn numbers_and_lists_are_in_words() {
        assert_eq!(in_words("0 is not in 1..=9"), "give a whole number from 1 to 9");
        assert_eq!(in_words("invalid digit found in string"), "give a whole number");
        assert_eq!(in_words("another"), "another");
        assert_eq!([either(&["a"]), either(&["a", "b"]), either(&["a", "b", "c"])], ["a", "a or b", "a, b or c"]);
        assert_eq!(["--size <WxH>", "[MESH]...", "--eye=1"].map(flag_of), ["--size", "MESH", "--eye"]);
        assert_eq!(said("render --size"), "--size needs a value; write --size <WxH>; see catoptric render --help");
    }
}
