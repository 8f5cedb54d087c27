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
        });
        name
    }

    fn expression(&mut self, place: usize, t: &[String]) -> String {
        let is_c = self.language == Language::C;
        let call = |c: &str, python: &str| format!("{}({})", if is_c { c } else { python }, t.join(", "));
        let between = |c: &str, python: &str| format!("({} {} {})", t[0], if is_c { c } else { python }, t[1]);
        match &self.nodes[place] {
            Node::Number(bits) => number(f64::from_bits(*bits), is_c),
            Node::Name(name) => {
                self.inputs.push(name.clone());
                // The model's numbers are macros in C, where such names belong to everybody.
                let is_macro = is_c && name.starts_with(char::is_uppercase);
                if is_macro { format!("{PREFIX}{name}") } else { name.clone() }
            }
            Node::Add(..) => between("+", "+"),
            Node::Subtract(..) => between("-", "-"),
            Node::Multiply(..) => between("*", "*"),
            Node::Divide(..) if is_c => between("/", "/"),
            Node::Divide(..) => call("", "_divide"),
            Node::Negate(..) => format!("(-{})", t[0]),
            Node::Absolute(..) => call("fabs", "abs"),
            Node::Root(..) => call("sqrt", "_sqrt"),
            Node::Sine(..) => call("sin", "_sin"),
            Node::Exponential(..) => call("exp", "_exp"),
            Node::Logarithm(..) => call("log", "_log"),
            Node::Power(..) => call("pow", "_pow"),
            Node::Select(..) if is_c => format!("({} ? {} : {})", t[0], t[1], t[2]),
            Node::Select(..) => format!("({} if {} else {})", t[1], t[0], t[2]),
            Node::Known(value) if is_c => i32::from(*value).to_string(),
            Node::Known(value) => if *value { "True" } else { "False" }.to_owned(),
            Node::Less(..) => between("<", "<"),
            Node::LessOrEqual(..) => between("<=", "<="),
            Node::And(..) => between("&&", "and"),
            Node::Or(..) => between("||", "or"),
            Node::Not(..) => format!("({}{})", if is_c { "!" } else { "not " }, t[0]),
        }
    }
}

/// The shortest text that reads back the same.
fn number(value: f64, is_c: bool) -> String {
    match (value.is_nan(), value.is_infinite(), is_c) {
        (true, _, true) => "NAN".to_owned(),
        (true, _, false) => "math.nan".to_owned(),
        (_, true, true) => if value > 0.0 { "INFINITY" } else { "(-INFINITY)" }.to_owned(),
        (_, true, false) => if value > 0.0 { "math.inf" } else { "(-math.inf)" }.to_owned(),
        _ => format!("{value:?}"),
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
