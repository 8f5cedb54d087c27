//! Drawings as SVG, without a browser.

pub mod overlay;
