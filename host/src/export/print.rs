//! Formulas as text, in one language or the other: a line for each value that is used more than once, the rest within
//! the lines that use it.

use super::Language;
use super::symbol::{Node, Symbol, Truth};
use super::trace::Function;

/// Longer expressions get a line of their own.
const LINE: usize = 90;

/// Before the names of the model's numbers in C.
pub(super) const PREFIX: &str = "RIG_";

/// The lines of a function's body.
pub(super) struct Body {
    /// Names that it takes, in no particular order.
    pub(super) inputs: Vec<String>,
    /// Lines before the condition, and after it.
    pub(super) before: Vec<String>,
    pub(super) condition: Option<String>,
    pub(super) after: Vec<String>,
    /// Name and value of each output.
    pub(super) outputs: Vec<(String, String)>,
    pub(super) result: Option<String>,
}

pub(super) fn body(function: &Function, language: Language) -> Body {
    let mut printer = Printer::new(function, language);
    let condition = function.condition.map(|Truth(place)| printer.text(place));
    let before = std::mem::take(&mut printer.lines);
    let outputs = function.outputs.iter().map(|(name, Symbol(place))| (name.clone(), printer.text(*place))).collect();
    let result = function.result.map(|Symbol(place)| printer.text(place));
    Body { inputs: printer.inputs, before, condition, after: printer.lines, outputs, result }
}

struct Printer<'a> {
    nodes: &'a [Node],
    language: Language,
    n_uses: Vec<usize>,
    texts: Vec<Option<String>>,
    lines: Vec<String>,
    n_lines: usize,
    inputs: Vec<String>,
}

impl<'a> Printer<'a> {
    fn new(function: &'a Function, language: Language) -> Self {
        let nodes = &function.graph.nodes;
        let mut printer = Self {
            nodes,
            language,
            n_uses: vec![0; nodes.len()],
            texts: vec![None; nodes.len()],
            lines: Vec::new(),
            n_lines: 0,
            inputs: Vec::new(),
        };
        let outputs = function.outputs.iter().map(|(_, symbol)| symbol.0);
        let ends = outputs.chain(function.result.map(|symbol| symbol.0)).chain(function.condition.map(|truth| truth.0));
        ends.collect::<Vec<_>>().into_iter().for_each(|place| printer.count(place));
        printer
    }

    fn count(&mut self, place: usize) {
        self.n_uses[place] += 1;
        if self.n_uses[place] == 1 {
            parts(&self.nodes[place]).into_iter().for_each(|part| self.count(part));
        }
    }

    /// The text by which a node is used, after the lines it needs.
    fn text(&mut self, place: usize) -> String {
        if let Some(text) = &self.texts[place] {
            return text.clone();
        }
        let texts: Vec<String> = parts(&self.nodes[place]).into_iter().map(|part| self.text(part)).collect();
        let text = self.expression(place, &texts);
        let is_leaf = texts.is_empty();
        let text =
            if !is_leaf && (self.n_uses[place] > 1 || text.len() > LINE) { self.line(place, &text) } else { text };
        self.texts[place] = Some(text.clone());
        text
    }

    fn line(&mut self, place: usize, text: &str) -> String {
        self.n_lines += 1;
        let name = format!("t{}", self.n_lines);
        let bare = without_parentheses(text);
        self.lines.push(match (self.language, is_truth(&self.nodes[place])) {
            (Language::C, true) => format!("const int {name} = {bare};"),
            (Language::C, false) => format!("const double {name} = {bare};"),
            (Language::Python, _) => format!("{name} = {bare}"),
            (Language::Matlab, _) => format!("{name} = {bare};"),
        });
        name
    }

    fn expression(&mut self, place: usize, t: &[String]) -> String {
        let Spelling { function, operator } = Spelling::of(self.language);
        let call = |name: &str| format!("{}({})", function(name), t.join(", "));
        let between = |sign: &str| format!("({} {} {})", t[0], operator(sign), t[1]);
        match &self.nodes[place] {
            Node::Number(bits) => number(f64::from_bits(*bits), self.language),
            Node::Name(name) => {
                self.inputs.push(name.clone());
                self.name(name)
            }
            Node::Add(..) => between("+"),
            Node::Subtract(..) => between("-"),
            Node::Multiply(..) => between("*"),
            // Python stops at a division by zero, the others go on.
            Node::Divide(..) if self.language == Language::Python => call("divide"),
            Node::Divide(..) => between("/"),
            Node::Negate(..) => format!("(-{})", t[0]),
            Node::Absolute(..) => call("abs"),
            Node::Root(..) => call("sqrt"),
            Node::Sine(..) => call("sin"),
            Node::Exponential(..) => call("exp"),
            Node::Logarithm(..) => call("log"),
            Node::Power(..) => call("pow"),
            Node::Select(..) => match self.language {
                Language::C => format!("({} ? {} : {})", t[0], t[1], t[2]),
                Language::Python => format!("({} if {} else {})", t[1], t[0], t[2]),
                Language::Matlab => call("choose"),
            },
            Node::Known(value) => match (self.language, value) {
                (Language::C, value) => i32::from(*value).to_string(),
                (Language::Python, true) => "True".to_owned(),
                (Language::Python, false) => "False".to_owned(),
                (Language::Matlab, value) => value.to_string(),
            },
            Node::Less(..) => between("<"),
            Node::LessOrEqual(..) => between("<="),
            Node::And(..) => between("&&"),
            Node::Or(..) => between("||"),
            Node::Not(..) => format!("({}{})", operator("!"), t[0]),
        }
    }

    /// The model's numbers are macros in C, where such names belong to everybody, and fields in MATLAB.
    fn name(&self, name: &str) -> String {
        match (self.language, name.starts_with(char::is_uppercase)) {
            (Language::C, true) => format!("{PREFIX}{name}"),
            (Language::Matlab, true) => format!("p.{name}"),
            _ => name.to_owned(),
        }
    }
}

/// What functions and operators of C are called in a language.
struct Spelling {
    function: fn(&str) -> String,
    operator: fn(&str) -> &str,
}

impl Spelling {
    fn of(language: Language) -> Self {
        match language {
            Language::C => {
                Self { function: |name| if name == "abs" { "fabs".into() } else { name.into() }, operator: |sign| sign }
            }
            Language::Python => Self {
                function: |name| if name == "abs" { name.into() } else { format!("_{name}") },
                operator: |sign| match sign {
                    "&&" => "and",
                    "||" => "or",
                    "!" => "not ",
                    sign => sign,
                },
            },
            Language::Matlab => Self {
                function: |name| match name {
                    "abs" | "sin" | "exp" => name.into(),
                    name => format!("rig_{name}"),
                },
                operator: |sign| if sign == "!" { "~" } else { sign },
            },
        }
    }
}

/// The shortest text that reads back the same.
fn number(value: f64, language: Language) -> String {
    let [nan, inf] = match language {
        Language::C => ["NAN", "INFINITY"],
        Language::Python => ["math.nan", "math.inf"],
        Language::Matlab => ["NaN", "Inf"],
    };
    match value {
        value if value.is_nan() => nan.to_owned(),
        f64::INFINITY => inf.to_owned(),
        f64::NEG_INFINITY => format!("(-{inf})"),
        value => format!("{value:?}"),
    }
}

fn is_truth(node: &Node) -> bool {
    use Node::{And, Known, Less, LessOrEqual, Not, Or};
    matches!(node, Known(_) | Less(..) | LessOrEqual(..) | And(..) | Or(..) | Not(_))
}

/// What a node is made of.
fn parts(node: &Node) -> Vec<usize> {
    match node {
        Node::Number(_) | Node::Name(_) | Node::Known(_) => Vec::new(),
        Node::Negate(a) | Node::Absolute(a) | Node::Root(a) | Node::Sine(a) => vec![a.0],
        Node::Exponential(a) | Node::Logarithm(a) => vec![a.0],
        Node::Add(a, b)
        | Node::Subtract(a, b)
        | Node::Multiply(a, b)
        | Node::Divide(a, b)
        | Node::Power(a, b)
        | Node::Less(a, b)
        | Node::LessOrEqual(a, b) => vec![a.0, b.0],
        Node::Select(mask, a, b) => vec![mask.0, a.0, b.0],
        Node::And(a, b) | Node::Or(a, b) => vec![a.0, b.0],
        Node::Not(a) => vec![a.0],
    }
}

/// Takes parentheses around the whole away.
pub(super) fn without_parentheses(text: &str) -> &str {
    let Some(inside) = text.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')) else { return text };
    let mut depth = 0_i32;
    for c in inside.chars() {
        depth += i32::from(c == '(') - i32::from(c == ')');
        if depth < 0 {
            return text;
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_parentheses_around_the_whole_are_taken_away() {
        assert_eq!(without_parentheses("(a + b)"), "a + b");
        assert_eq!(without_parentheses("(a) + (b)"), "(a) + (b)");
        assert_eq!(without_parentheses("sin(a)"), "sin(a)");
    }
}
