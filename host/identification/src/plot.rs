//! Pictures, before it is decided how they are drawn: [`svg`] draws them for paper; the program, for the browser.
//! [`overlay`] is the drawing of a fit, with its own layout.

pub mod decimate;
pub mod friction;
pub mod overlay;
pub mod staircase;
pub mod svg;

use serde::Serialize;

/// A picture with its explanation.
#[derive(Clone, Debug, Serialize)]
pub struct Picture {
    /// File name without ending.
    pub key: String,
    /// Above the picture.
    pub title: String,
    /// Below it, for somebody who has never seen such a picture.
    pub explanation: String,
    /// Across.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// What is drawn.
    pub content: Content,
}

impl Picture {
    /// The same of a pendulum of which only the motion is known: its torques are per m·g·l.
    pub fn per_gravity(mut self) -> Self {
        let own = |text: &str| text.replace("mJ/rad = mN·m", PER_GRAVITY).replace("mN·m", PER_GRAVITY);
        self.y.label = own(&self.y.label);
        self.explanation = own(&self.explanation);
        if let Content::Heat(heat) = &mut self.content {
            heat.label = own(&heat.label);
            heat.notes.iter_mut().flatten().for_each(|note| *note = own(note));
        }
        self
    }
}

/// The unit of such torques, in thousandths.
const PER_GRAVITY: &str = "10⁻³ m·g·l";

/// An axis.
#[derive(Clone, Debug, Serialize)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// Equal factors instead of equal steps.
    pub is_logarithmic: bool,
    /// Whole numbers only.
    pub is_count: bool,
    /// Names of 0, 1, 2 …, if these are no numbers.
    pub names: Vec<String>,
}

impl Axis {
    /// Equal steps.
    pub fn linear(label: &str) -> Self {
        Self { label: label.to_owned(), is_logarithmic: false, is_count: false, names: Vec::new() }
    }

    /// Things in their order.
    pub fn counted(label: &str) -> Self {
        Self { is_count: true, ..Self::linear(label) }
    }

    /// Things with names.
    pub fn named(label: &str, names: Vec<String>) -> Self {
        Self { names, ..Self::linear(label) }
    }

    /// Equal factors.
    pub fn logarithmic(label: &str) -> Self {
        Self { is_logarithmic: true, ..Self::linear(label) }
    }
}

/// What a picture shows.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Content {
    /// Lines and dots.
    Curves(Vec<Curve>),
    /// Values over a plane.
    Heat(Heat),
}

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Style {
    /// A line.
    Line,
    /// A broken line, for limits and expectations.
    Dashed,
    /// Dots, with error bars where there are some.
    Dots,
    /// Small faint dots, for many samples.
    Cloud,
}

/// A line or a set of dots.
#[derive(Clone, Debug, Serialize)]
pub struct Curve {
    /// In the legend.
    pub name: String,
    /// How it is drawn.
    pub style: Style,
    /// Which of the colours; equal numbers belong together.
    pub colour: usize,
    /// Across.
    pub x: Vec<f64>,
    /// Upwards.
    pub y: Vec<f64>,
    /// Half lengths of error bars.
    pub bars: Option<Vec<f64>>,
}

impl Curve {
    /// A curve without error bars.
    pub fn new(name: &str, style: Style, colour: usize, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let (x, y) = points.into_iter().filter(|(x, y)| x.is_finite() && y.is_finite()).unzip();
        Self { name: name.to_owned(), style, colour, x, y, bars: None }
    }

    /// Dots with error bars: x, y and half length of the bar.
    pub fn with_bars(name: &str, colour: usize, points: impl IntoIterator<Item = (f64, f64, f64)>) -> Self {
        let mut curve = Self::new(name, Style::Dots, colour, []);
        let mut bars = Vec::new();
        for (x, y, bar) in points {
            curve.x.push(x);
            curve.y.push(y);
            bars.push(bar);
        }
        curve.bars = Some(bars);
        curve
    }
}

/// Values over a plane, in rows upwards.
#[derive(Clone, Debug, Serialize)]
pub struct Heat {
    /// Middles of the columns.
    pub x: Vec<f64>,
    /// Middles of the rows.
    pub y: Vec<f64>,
    /// Names instead of numbers along both axes, if they are no quantities.
    pub names: Option<Vec<String>>,
    /// Rows of values; `None` where there are no data.
    pub values: Vec<Vec<Option<f64>>>,
    /// What is said of every value when pointed at.
    pub notes: Vec<Vec<String>>,
    /// Quantity and unit of the values.
    pub label: String,
    /// Colours go from minus this to this.
    pub limit: f64,
}

/// Seven colours that the colour-blind can tell apart (M. Okabe, K. Ito, 2008), darkest first.
pub const COLOURS: [(u8, u8, u8); 7] =
    [(0, 114, 178), (213, 94, 0), (0, 158, 115), (204, 121, 167), (86, 180, 233), (230, 159, 0), (0, 0, 0)];

/// A colour by its number.
pub fn colour(number: usize) -> (u8, u8, u8) {
    COLOURS[number % COLOURS.len()]
}

/// Blue for negative, white for zero, red for positive; `share` from −1 to 1.
pub fn diverging(share: f64) -> (u8, u8, u8) {
    let end = if share < 0.0 { (33.0, 102.0, 172.0) } else { (178.0, 24.0, 43.0) };
    let blend = |end: f64| (255.0 + (end - 255.0) * share.abs().min(1.0)) as u8;
    (blend(end.0), blend(end.1), blend(end.2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn red_is_positive_blue_is_negative_and_white_is_nothing() {
        let [low, none, high] = [-1.0, 0.0, 1.0].map(diverging);
        assert!(low.2 > low.0 && high.0 > high.2, "{low:?} {high:?}");
        assert_eq!(none, (255, 255, 255));
        assert_eq!(diverging(7.0), high);
    }
}
