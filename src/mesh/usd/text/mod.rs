//! USDA as openusd 0.8 reads it, made of USDA as people write it, before it is parsed.
//!
//! openusd refuses a layer for numbers such as `.5` and `1e3` (of an int), for `//` comments, for escapes in long strings, and for any value
//! whose type it does not expect, though nobody needs it. So the text is written again, token by token:
//!
//! * numbers, strings and truth values become their plainest form, comments go;
//! * of the attributes those stay that meshes and their places are made of ([`ATTRIBUTES`]), of the metadata those that compose
//!   the stage ([`LAYER`], [`PRIM`]); everything else goes, whatever it holds;
//! * every line keeps its number, so that messages name the line of the file.
//!
//! What this does not understand stays as it is, for openusd to judge.

mod token;
mod write;

#[cfg(test)]
mod tests;

use token::{Kind, Token, Tokens, breaks};

/// The name under which `inactiveIds` reaches the stage: openusd takes no list operations in that field.
pub(super) const INACTIVE_IDS: &str = "catoptric_inactiveIds";

/// Attributes of meshes, of their places and of point instancers; transforms beside them.
const ATTRIBUTES: [&str; 28] = [
    "points",
    "velocities",
    "accelerations",
    "faceVertexCounts",
    "faceVertexIndices",
    "creaseIndices",
    "creaseLengths",
    "creaseSharpnesses",
    "cornerIndices",
    "cornerSharpnesses",
    "holeIndices",
    "subdivisionScheme",
    "interpolateBoundary",
    "triangleSubdivisionRule",
    "orientation",
    "visibility",
    "purpose",
    "xformOpOrder",
    "protoIndices",
    "ids",
    "invisibleIds",
    "positions",
    "orientations",
    "orientationsf",
    "scales",
    "angularVelocities",
    "primvars:skel:jointIndices",
    "skel:blendShapes",
];

/// Relationships that lead to nothing with points.
const OTHER_TARGETS: [&str; 5] = ["material:", "collection:", "skel:", "light:", "proxyPrim"];

/// Metadata of the layer that is needed.
const LAYER: [&str; 10] = [
    "defaultPrim",
    "subLayers",
    "upAxis",
    "metersPerUnit",
    "timeCodesPerSecond",
    "framesPerSecond",
    "startTimeCode",
    "endTimeCode",
    "relocates",
    "expressionVariables",
];

/// Metadata of a prim that is needed.
const PRIM: [&str; 12] = [
    "active",
    "instanceable",
    "references",
    "payload",
    "inherits",
    "specializes",
    "variants",
    "variantSets",
    "relocates",
    "clips",
    "clipSets",
    "inactiveIds",
];

const LIST_OPERATIONS: [&str; 5] = ["add", "append", "prepend", "delete", "reorder"];

/// Prims one in another that are followed; what is deeper stays as it is.
const DEEPEST: usize = 300;

/// How numbers of a value are written.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Numbers {
    AsTheyAre,
    /// Cut off behind the point, as usd-core reads them.
    Whole,
}

/// Whether what is read is written.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Fate {
    Kept(Numbers),
    Dropped,
}

/// The text of a layer in its plainest form; what is not USDA comes back as it is.
pub(super) fn plain(text: &[u8]) -> Vec<u8> {
    let bare = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    // The first line is the header, whatever follows the version.
    if !bare.strip_prefix(b"#usda ").is_some_and(|version| version.trim_ascii_start().starts_with(b"1.")) {
        return text.to_vec();
    }
    let header = bare.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(bare.len());
    let mut plain =
        Plain { tokens: Tokens::new(&bare[header..]), next: None, out: Vec::with_capacity(bare.len()), depth: 0 };
    plain.out.extend_from_slice(b"#usda 1.0");
    if plain.peek().is_some_and(|token| token.is_mark(b'(')) {
        plain.metadata(&LAYER);
    }
    while plain.peek().is_some() {
        plain.body();
    }
    plain.out.push(b'\n');
    plain.out
}

/// A text that is being written again.
struct Plain<'a> {
    tokens: Tokens<'a>,
    next: Option<Token<'a>>,
    out: Vec<u8>,
    depth: usize,
}

impl<'a> Plain<'a> {
    fn peek(&mut self) -> Option<Token<'a>> {
        self.next = self.next.take().or_else(|| self.tokens.next());
        self.next
    }

    fn take(&mut self) -> Option<Token<'a>> {
        let token = self.peek();
        self.next = None;
        token
    }

    /// Takes the next token if it is that mark.
    fn take_mark(&mut self, mark: u8) -> Option<Token<'a>> {
        self.peek().filter(|token| token.is_mark(mark)).and_then(|_| self.take())
    }

    fn write(&mut self, token: Token<'_>) {
        self.separate(token.breaks);
        write::token(token, Numbers::AsTheyAre, &mut self.out);
    }

    fn write_all(&mut self, tokens: &[Token<'_>]) {
        tokens.iter().for_each(|token| self.write(*token));
    }

    fn separate(&mut self, breaks: usize) {
        match breaks {
            0 => self.out.push(b' '),
            _ => self.out.extend(std::iter::repeat_n(b'\n', breaks)),
        }
    }

    /// Leaves a token out, but not the lines that end in it.
    fn drop(&mut self, token: Token<'_>) {
        let lines = token.breaks + breaks(token.text);
        self.out.extend(std::iter::repeat_n(b'\n', lines));
    }

    fn settle(&mut self, token: Token<'_>, fate: Fate) {
        match fate {
            Fate::Kept(numbers) => {
                self.separate(token.breaks);
                write::token(token, numbers, &mut self.out);
            }
            Fate::Dropped => self.drop(token),
        }
    }

    fn settle_all(&mut self, tokens: &[Token<'_>], fate: Fate) {
        tokens.iter().for_each(|token| self.settle(*token, fate));
    }

    /// What is in the braces of a prim or variant, the closing one included; or the whole layer.
    fn body(&mut self) {
        while let Some(token) = self.peek() {
            match token.kind {
                Kind::Mark if token.is_mark(b'}') => {
                    self.take();
                    return self.write(token);
                }
                Kind::Mark if token.is_mark(b';') => {
                    self.take();
                    self.drop(token);
                }
                Kind::Name if ["def", "over", "class"].iter().any(|name| token.is_name(name)) => self.prim(),
                Kind::Name if token.is_name("variantSet") => self.variant_set(),
                Kind::Name => self.property(),
                _ => {
                    self.take();
                    self.write(token);
                }
            }
        }
    }

    /// Braces, and what is in them.
    fn braces(&mut self, inside: fn(&mut Self)) {
        if let Some(open) = self.take_mark(b'{') {
            self.write(open);
            // What is deeper is refused for its depth, later.
            if self.depth < DEEPEST {
                self.depth += 1;
                inside(self);
                self.depth -= 1;
            }
        }
    }

    /// `def Mesh "name" (metadata) { ... }`
    fn prim(&mut self) {
        let Some(specifier) = self.take() else { return };
        self.write(specifier);
        if let Some(kind) = self.peek().filter(|token| token.kind == Kind::Name) {
            self.take();
            // A type that has another name than types have is none that we read.
            let is_known = kind.text.iter().all(|byte| byte.is_ascii_alphanumeric() || *byte == b'_');
            self.settle(kind, if is_known { Fate::Kept(Numbers::AsTheyAre) } else { Fate::Dropped });
        }
        self.named_body();
    }

    /// `"name" (metadata) { ... }`
    fn named_body(&mut self) {
        let Some(name) = self.peek().filter(|token| token.kind == Kind::Text) else { return };
        self.take();
        self.write(name);
        if self.peek().is_some_and(|token| token.is_mark(b'(')) {
            self.metadata(&PRIM);
        }
        self.braces(Self::body);
    }

    /// `variantSet "name" = { "variant" (metadata) { ... } ... }`
    fn variant_set(&mut self) {
        let Some(keyword) = self.take() else { return };
        self.write(keyword);
        for kind in [Kind::Text, Kind::Mark] {
            match self.peek().filter(|token| token.kind == kind && !token.is_mark(b'{')) {
                Some(token) => {
                    self.take();
                    self.write(token);
                }
                None => return,
            }
        }
        self.braces(Self::variants);
    }

    fn variants(&mut self) {
        while let Some(token) = self.peek() {
            match token.kind {
                Kind::Text => self.named_body(),
                _ => {
                    self.take();
                    match token {
                        _ if token.is_mark(b';') => self.drop(token),
                        _ => self.write(token),
                    }
                    if token.is_mark(b'}') {
                        return;
                    }
                }
            }
        }
    }

    /// Metadata in parentheses, of which some is kept.
    fn metadata(&mut self, kept: &[&str]) {
        if let Some(open) = self.take_mark(b'(') {
            self.write(open);
        }
        let mut next = None;
        while let Some(token) = next.take().or_else(|| self.take()) {
            match token.kind {
                Kind::Name => next = self.metadatum(token, kept),
                // A comment, and what stands between entries.
                Kind::Text => self.drop(token),
                Kind::Mark if token.is_mark(b';') || token.is_mark(b',') => self.drop(token),
                _ => {
                    self.write(token);
                    if token.is_mark(b')') {
                        return;
                    }
                }
            }
        }
    }

    /// `prepend name = value`, from its first word on. Gives the first word of the next entry where it had to look at that.
    fn metadatum(&mut self, first: Token<'a>, kept: &[&str]) -> Option<Token<'a>> {
        let mut head = vec![first];
        if LIST_OPERATIONS.iter().any(|operation| first.is_name(operation))
            && let Some(name) = self.peek().filter(|token| token.kind == Kind::Name)
        {
            self.take();
            head.push(name);
        }
        let Some(equals) = self.take_mark(b'=') else {
            self.write_all(&head);
            return None;
        };
        let name = head[head.len() - 1];
        let is_kept = kept.iter().any(|kept| name.is_name(kept));
        if name.is_name("inactiveIds") && is_kept {
            let last = head.len() - 1;
            head[last].text = INACTIVE_IDS.as_bytes();
        }
        head.push(equals);
        let fate = if is_kept { Fate::Kept(Numbers::AsTheyAre) } else { Fate::Dropped };
        self.settle_all(&head, fate);
        if is_kept && (name.is_name("active") || name.is_name("instanceable")) {
            self.truth();
            return None;
        }
        // An entry may have no value, such as `symmetryFunction =`: then the next one follows.
        if let Some(next) = self.take_name() {
            if self.peek().is_some_and(|token| token.is_mark(b'=')) {
                return Some(next);
            }
            self.settle(next, fate);
            return None;
        }
        self.value(fate);
        // An arc: the prim in the layer, and an offset.
        if let Some(path) = self.peek().filter(|token| token.kind == Kind::Path) {
            self.take();
            self.settle(path, fate);
        }
        if self.peek().is_some_and(|token| token.is_mark(b'(')) {
            self.group(fate);
        }
        None
    }

    /// A truth value: `true`, `no`, `1`, `"True"`.
    fn truth(&mut self) {
        let Some(token) = self.peek().filter(|token| !matches!(token.kind, Kind::Mark | Kind::Rest)) else { return };
        self.take();
        match write::truth(token) {
            Some(text) => {
                self.separate(token.breaks);
                self.out.extend_from_slice(text.as_bytes());
            }
            None => self.write(token),
        }
    }

    /// A value: what is in brackets, parentheses or braces, else a single token.
    fn value(&mut self, fate: Fate) {
        match self.peek() {
            Some(token) if [b'[', b'(', b'{'].iter().any(|&open| token.is_mark(open)) => self.group(fate),
            // A bracket that closes belongs to somebody else.
            Some(token) if token.kind == Kind::Mark => {}
            Some(token) => {
                self.take();
                self.settle(token, fate);
                // A word with a list, as of what edits an array.
                if token.kind == Kind::Name && self.peek().is_some_and(|next| next.is_mark(b'[') || next.is_mark(b'{'))
                {
                    self.group(fate);
                }
            }
            None => {}
        }
    }

    /// Brackets of any kind and what is in them.
    fn group(&mut self, fate: Fate) {
        let mut open = 0_usize;
        while let Some(token) = self.take() {
            self.settle(token, fate);
            match token.text {
                [b'[' | b'(' | b'{'] => open += 1,
                [b']' | b')' | b'}'] => open = open.saturating_sub(1),
                _ => {}
            }
            if open == 0 {
                return;
            }
        }
    }

    /// `{ time: value, ... }`
    fn samples(&mut self, fate: Fate) {
        let Some(open) = self.take_mark(b'{') else { return };
        self.settle(open, fate);
        let as_it_is = if fate == Fate::Dropped { fate } else { Fate::Kept(Numbers::AsTheyAre) };
        while let Some(token) = self.take() {
            self.settle(token, as_it_is);
            if token.is_mark(b'}') {
                return;
            }
            if token.is_mark(b':') {
                self.value(fate);
            }
        }
    }

    /// An attribute, a relationship or a `reorder`, with its value and metadata.
    fn property(&mut self) {
        let mut head: Vec<Token<'a>> = Vec::with_capacity(8);
        let mut is_relationship = false;
        // Words before the type.
        while let Some(token) = self.peek().filter(|token| token.kind == Kind::Name) {
            let is_word = ["custom", "uniform", "varying", "config"].iter().any(|word| token.is_name(word));
            if is_word || (head.is_empty() && LIST_OPERATIONS.iter().any(|operation| token.is_name(operation))) {
                self.take();
                match token.is_name("config") {
                    true => self.drop(token),
                    false => head.push(token),
                }
            } else {
                is_relationship = token.is_name("rel");
                break;
            }
        }
        let Some(kind) = self.take_name() else { return self.write_all(&head) };
        head.push(kind);
        if head.len() == 2
            && head[0].is_name("reorder")
            && ["nameChildren", "properties", "rootPrims"].iter().any(|name| kind.is_name(name))
        {
            let fate = if kind.is_name("properties") { Fate::Dropped } else { Fate::Kept(Numbers::AsTheyAre) };
            self.settle_all(&head, fate);
            return self.assigned(fate, Self::value);
        }
        for mark in [b'[', b']'] {
            if let Some(bracket) = self.take_mark(mark) {
                head.push(bracket);
            }
        }
        let Some(name) = self.take_name() else { return self.write_all(&head) };
        head.push(name);
        let mut suffix = None;
        if let Some(dot) = self.take_mark(b'.') {
            head.push(dot);
            suffix = self.take_name();
            head.extend(suffix);
        }
        let is_needed = match is_relationship {
            true => !OTHER_TARGETS.iter().any(|start| name.text.starts_with(start.as_bytes())),
            false => name.text.starts_with(b"xformOp:") || ATTRIBUTES.iter().any(|needed| name.is_name(needed)),
        };
        // What no mesh can use, whatever its name is.
        let is_needed = is_needed && !["asset", "opaque", "pathExpression"].iter().any(|other| kind.is_name(other));
        let is_value = suffix.is_none_or(|suffix| ["timeSamples", "spline"].iter().any(|kind| suffix.is_name(kind)));
        let are_whole = ["int", "int64", "uint", "uint64", "uchar"].iter().any(|whole| kind.is_name(whole));
        let numbers = if are_whole { Numbers::Whole } else { Numbers::AsTheyAre };
        let fate = if is_needed && is_value { Fate::Kept(numbers) } else { Fate::Dropped };
        self.settle_all(&head, fate);
        match suffix.is_some_and(|suffix| suffix.is_name("timeSamples")) {
            true => self.assigned(fate, Self::samples),
            false => self.assigned(fate, Self::value),
        }
    }

    fn take_name(&mut self) -> Option<Token<'a>> {
        self.peek().filter(|token| token.kind == Kind::Name).and_then(|_| self.take())
    }

    /// Metadata, which go, and ` = value` if there is one.
    fn assigned(&mut self, fate: Fate, value: fn(&mut Self, Fate)) {
        for is_before in [true, false] {
            if self.peek().is_some_and(|token| token.is_mark(b'(')) {
                self.group(Fate::Dropped);
            }
            if is_before && let Some(equals) = self.take_mark(b'=') {
                self.settle(equals, fate);
                value(self, fate);
            }
        }
    }
}
