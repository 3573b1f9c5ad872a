//! Expressions in x and y: read once, evaluated in f64, written as WGSL.

use glam::DVec2;
use std::fmt;
use std::str::FromStr;

/// An expression in x and y: numbers, `pi`, + - * / ^, parentheses, and functions by name.
#[derive(Debug, Clone, PartialEq)]
pub struct Expression {
    text: String,
    root: Node,
}

/// Why an expression was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("at character {at} of \"{text}\": {what}")]
pub struct ExpressionError {
    text: String,
    at: usize,
    what: String,
}

#[derive(Debug, Clone, PartialEq)]
enum Node {
    Number(f64),
    X,
    Y,
    Negative(Box<Node>),
    Binary(char, Box<[Node; 2]>),
    Call(&'static Function, Vec<Node>),
}

/// A function, by the name that it has in WGSL too.
#[derive(Debug, Clone, Copy)]
struct Function {
    name: &'static str,
    arguments: usize,
    apply: fn(&[f64]) -> f64,
}

impl Function {
    const fn new(name: &'static str, arguments: usize, apply: fn(&[f64]) -> f64) -> Function {
        Function { name, arguments, apply }
    }
}

/// There is one function of each name.
impl PartialEq for Function {
    fn eq(&self, other: &Function) -> bool {
        self.name == other.name
    }
}

static FUNCTIONS: [Function; 14] = [
    Function::new("sqrt", 1, |a| a[0].sqrt()),
    Function::new("abs", 1, |a| a[0].abs()),
    Function::new("sin", 1, |a| a[0].sin()),
    Function::new("cos", 1, |a| a[0].cos()),
    Function::new("tan", 1, |a| a[0].tan()),
    Function::new("exp", 1, |a| a[0].exp()),
    Function::new("log", 1, |a| a[0].ln()),
    Function::new("sign", 1, |a| if a[0] == 0.0 { 0.0 } else { a[0].signum() }),
    Function::new("floor", 1, |a| a[0].floor()),
    Function::new("tanh", 1, |a| a[0].tanh()),
    Function::new("atan2", 2, |a| a[0].atan2(a[1])),
    Function::new("min", 2, |a| a[0].min(a[1])),
    Function::new("max", 2, |a| a[0].max(a[1])),
    Function::new("pow", 2, |a| a[0].powf(a[1])),
];

/// Deepest nesting: a reader by recursion must not run out of stack.
const DEEPEST: usize = 64;
/// Most characters of an expression.
const LONGEST: usize = 4096;
/// Most operands, with whole powers multiplied out as shaders have them.
const LARGEST: usize = 10_000;

impl Expression {
    /// Its value at a point; not finite where it has none.
    pub fn value(&self, at: DVec2) -> f64 {
        self.root.value(at)
    }

    /// As a WGSL expression of `x` and `y`.
    pub(crate) fn wgsl(&self) -> String {
        self.root.wgsl()
    }
}

impl fmt::Display for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl FromStr for Expression {
    type Err = ExpressionError;

    fn from_str(text: &str) -> Result<Self, ExpressionError> {
        let mut reader = Reader { text, at: 0, depth: 0 };
        if text.len() > LONGEST {
            return Err(reader.error(format!("more than {LONGEST} characters")));
        }
        let root = reader.sum()?;
        match reader.peek() {
            None if root.size() > LARGEST => {
                Err(reader.error(format!("more than {LARGEST} operands when its powers are multiplied out")))
            }
            None => Ok(Expression { text: text.to_owned(), root }),
            Some(c) => Err(reader.error(format!("{c} does not belong here"))),
        }
    }
}

impl Node {
    fn value(&self, at: DVec2) -> f64 {
        match self {
            Node::Number(x) => *x,
            Node::X => at.x,
            Node::Y => at.y,
            Node::Negative(a) => -a.value(at),
            Node::Binary(operator, sides) => {
                let [a, b] = sides.each_ref().map(|side| side.value(at));
                match operator {
                    '+' => a + b,
                    '-' => a - b,
                    '*' => a * b,
                    '/' => a / b,
                    _ => a.powf(b),
                }
            }
            Node::Call(function, arguments) => {
                (function.apply)(&arguments.iter().map(|argument| argument.value(at)).collect::<Vec<_>>())
            }
        }
    }

    /// Number of operands, with whole powers multiplied out.
    fn size(&self) -> usize {
        let power = |base: &Node, exponent: &Node| match factors(exponent) {
            Some(count) => base.size().saturating_mul(count),
            None => base.size().saturating_add(exponent.size()),
        };
        match self {
            Node::Number(_) | Node::X | Node::Y => 1,
            Node::Negative(a) => a.size(),
            Node::Binary('^', sides) => power(&sides[0], &sides[1]),
            Node::Binary(_, sides) => sides[0].size().saturating_add(sides[1].size()),
            Node::Call(Function { name: "pow", .. }, arguments) => power(&arguments[0], &arguments[1]),
            Node::Call(_, arguments) => arguments.iter().fold(0, |sum, argument| argument.size().saturating_add(sum)),
        }
    }

    fn wgsl(&self) -> String {
        match self {
            // Infinite literals are none in WGSL.
            Node::Number(x) => format!("{:?}", (*x as f32).clamp(f32::MIN, f32::MAX)),
            Node::X => "x".to_owned(),
            Node::Y => "y".to_owned(),
            Node::Negative(a) => format!("(-{})", a.wgsl()),
            Node::Binary('^', sides) => power(&sides[0].wgsl(), &sides[1]),
            Node::Binary(operator, sides) => {
                let left = sides[0].wgsl();
                // A row of the same rank is one: nested as deep as it is long, it would be too deep for a shader.
                let row = matches!(&sides[0], Node::Binary(before, _) if rank(*before) == rank(*operator));
                let left = if row { &left[1..left.len() - 1] } else { &left };
                format!("({left} {operator} {})", sides[1].wgsl())
            }
            Node::Call(Function { name: "pow", .. }, arguments) => power(&arguments[0].wgsl(), &arguments[1]),
            Node::Call(Function { name, .. }, arguments) => {
                format!("{name}({})", arguments.iter().map(Node::wgsl).collect::<Vec<_>>().join(", "))
            }
        }
    }
}

/// Operators of one rank are read from left to right.
fn rank(operator: char) -> u8 {
    match operator {
        '+' | '-' => 0,
        '*' | '/' => 1,
        _ => 2,
    }
}

/// WGSL's `pow` has no negative bases; whole exponents, as in x^2, need it none.
fn power(base: &str, exponent: &Node) -> String {
    match factors(exponent) {
        Some(count) => format!("({})", vec![base; count].join(" * ")),
        None => format!("pow({base}, {})", exponent.wgsl()),
    }
}

/// How many factors a power is multiplied out to; `None` where it is not.
fn factors(exponent: &Node) -> Option<usize> {
    match exponent {
        Node::Number(n) if n.fract() == 0.0 && (1.0..=8.0).contains(n) => Some(*n as usize),
        _ => None,
    }
}

/// Reads from left to right: sums of products of powers of atoms.
struct Reader<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
}

impl Reader<'_> {
    fn error(&self, what: impl Into<String>) -> ExpressionError {
        ExpressionError { text: self.text.to_owned(), at: self.text[..self.at].chars().count() + 1, what: what.into() }
    }

    /// The next character that is not white.
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    /// Takes the next character if it is one of these.
    fn take(&mut self, of: &[char]) -> Option<char> {
        let next = self.peek().filter(|c| of.contains(c))?;
        self.at += next.len_utf8();
        Some(next)
    }

    fn expect(&mut self, c: char) -> Result<(), ExpressionError> {
        self.take(&[c]).map(drop).ok_or_else(|| self.error(format!("expected {c}")))
    }

    fn sum(&mut self) -> Result<Node, ExpressionError> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.error(format!("nested more than {DEEPEST} deep")));
        }
        let mut node = self.product()?;
        while let Some(operator) = self.take(&['+', '-']) {
            node = Node::Binary(operator, Box::new([node, self.product()?]));
        }
        self.depth -= 1;
        Ok(node)
    }

    fn product(&mut self) -> Result<Node, ExpressionError> {
        let mut node = self.sign()?;
        while let Some(operator) = self.take(&['*', '/']) {
            node = Node::Binary(operator, Box::new([node, self.sign()?]));
        }
        Ok(node)
    }

    /// -x^2 is -(x^2).
    fn sign(&mut self) -> Result<Node, ExpressionError> {
        let mut negative = false;
        while let Some(sign) = self.take(&['-', '+']) {
            negative ^= sign == '-';
        }
        let node = self.power()?;
        Ok(if negative { Node::Negative(Box::new(node)) } else { node })
    }

    /// x^y^z is x^(y^z).
    fn power(&mut self) -> Result<Node, ExpressionError> {
        let base = self.atom()?;
        if self.take(&['^']).is_none() {
            return Ok(base);
        }
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.error(format!("nested more than {DEEPEST} deep")));
        }
        let exponent = self.sign()?;
        self.depth -= 1;
        Ok(Node::Binary('^', Box::new([base, exponent])))
    }

    fn atom(&mut self) -> Result<Node, ExpressionError> {
        match self.peek() {
            None => Err(self.error("something is missing at the end")),
            Some('(') => {
                self.expect('(')?;
                let node = self.sum()?;
                self.expect(')')?;
                Ok(node)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_ascii_alphabetic() => self.name(),
            Some(c) => Err(self.error(format!("{c} does not belong here"))),
        }
    }

    /// As Rust writes them, exponents included.
    fn number(&mut self) -> Result<Node, ExpressionError> {
        let rest = &self.text[self.at..];
        let mut end = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
        if let Some(exponent) = rest[end..].strip_prefix(['e', 'E']) {
            let digits = exponent.strip_prefix(['+', '-']).unwrap_or(exponent);
            let count = digits.find(|c: char| !c.is_ascii_digit()).unwrap_or(digits.len());
            if count > 0 {
                end += 1 + exponent.len() - digits.len() + count;
            }
        }
        let number = rest[..end].parse().ok().filter(|x: &f64| x.is_finite());
        let number = number.ok_or_else(|| self.error(format!("{} is no number", &rest[..end])))?;
        self.at += end;
        Ok(Node::Number(number))
    }

    fn name(&mut self) -> Result<Node, ExpressionError> {
        let rest = &self.text[self.at..];
        let name = &rest[..rest.find(|c: char| !c.is_ascii_alphanumeric()).unwrap_or(rest.len())];
        let constant = match name {
            "x" => Some(Node::X),
            "y" => Some(Node::Y),
            "pi" => Some(Node::Number(std::f64::consts::PI)),
            _ => None,
        };
        if let Some(node) = constant {
            self.at += name.len();
            return Ok(node);
        }
        let Some(function) = FUNCTIONS.iter().find(|function| function.name == name) else {
            let known: Vec<_> = FUNCTIONS.iter().map(|function| function.name).collect();
            return Err(self.error(format!("{name} is not known; there are x, y, pi, {}", known.join(", "))));
        };
        self.at += name.len();
        self.expect('(')?;
        let mut arguments = vec![self.sum()?];
        while self.take(&[',']).is_some() {
            arguments.push(self.sum()?);
        }
        self.expect(')')?;
        match arguments.len() == function.arguments {
            true => Ok(Node::Call(function, arguments)),
            false => Err(self.error(format!("{name} takes {} argument(s)", function.arguments))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str, x: f64, y: f64) -> f64 {
        text.parse::<Expression>().unwrap_or_else(|error| panic!("{error}")).value(DVec2::new(x, y))
    }

    #[test]
    fn expressions_mean_what_they_say() {
        assert_eq!(at("x^2 + y^2", 3.0, 4.0), 25.0);
        assert_eq!(at("-x^2", 3.0, 0.0), -9.0);
        assert_eq!(at("2^3^2", 0.0, 0.0), 512.0);
        assert_eq!(at("x - y - 1", 5.0, 2.0), 2.0);
        assert_eq!(at("x / y / 2", 8.0, 2.0), 2.0);
        assert_eq!(at("--x * -2", 3.0, 0.0), -6.0);
        assert_eq!(at(" 1.5e1 + .5 ", 0.0, 0.0), 15.5);
        assert_eq!(at("2^-1", 0.0, 0.0), 0.5);
        assert_eq!(at("max(abs(x), min(y, 7)) - sqrt(4)", -3.0, 9.0), 5.0);
        assert!(
            (at("sin(pi / 2) + atan2(y, x) + log(exp(1))", 1.0, 1.0) - 2.0 - 0.25 * std::f64::consts::PI).abs() < 1e-15
        );
        assert!(at("sqrt(x)", -1.0, 0.0).is_nan());
    }

    #[test]
    fn nonsense_is_refused_where_it_is() {
        let deep = format!("{}x{}", "(".repeat(100), ")".repeat(100));
        let tower = vec!["2"; 200].join("^");
        for (text, at) in [
            ("", 1),
            ("x +", 4),
            ("x y", 3),
            ("(x", 3),
            ("z", 1),
            ("sin x", 5),
            ("max(x)", 7),
            ("1.2.3", 1),
            ("x § y", 3),
        ] {
            let error = text.parse::<Expression>().expect_err(text);
            assert_eq!(error.at, at, "{text}: {error}");
        }
        let long = vec!["x"; 50_000].join("+");
        // Multiplied out it would fill memory.
        let powers = format!("{}x{}", "(".repeat(20), "^8)".repeat(20));
        for text in [deep, tower, long, powers] {
            assert!(text.parse::<Expression>().is_err());
        }
    }

    #[test]
    fn wgsl_says_the_same() {
        let wgsl = |text: &str| text.parse::<Expression>().expect(text).wgsl();
        assert_eq!(wgsl("x^2 - y/3"), "((x * x) - (y / 3.0))");
        assert_eq!(wgsl("-pow(x, 0.5)"), "(-pow(x, 0.5))");
        assert_eq!(wgsl("1e300"), "3.4028235e38");
        assert_eq!(wgsl("x - y + 1 - x*y/2*x"), "(x - y + 1.0 - (x * y / 2.0 * x))");
        assert_eq!(wgsl("x - (y - 1)"), "(x - (y - 1.0))");
        // naga nests 127 deep.
        assert!(!wgsl(&vec!["x"; 2000].join("+")).contains("(("));
    }
}
