//! Plots as SVG.

use std::path::Path;

use anyhow::{Result, anyhow};
use plotters::prelude::*;

/// Curves over one axis.
pub struct Chart<'a> {
    /// What stands below and beside it.
    pub axes: [&'a str; 2],
    /// Whether both axes are logarithmic, of powers of 2.
    pub logarithmic: bool,
    /// Names and points.
    pub curves: &'a [(String, Vec<[f64; 2]>)],
}

const SIZE: (u32, u32) = (640, 400);
const COLOURS: [RGBColor; 8] = [
    RGBColor(0, 90, 160),
    RGBColor(200, 80, 0),
    RGBColor(0, 130, 80),
    RGBColor(150, 40, 120),
    RGBColor(90, 90, 90),
    RGBColor(180, 140, 0),
    RGBColor(60, 150, 200),
    RGBColor(120, 60, 20),
];

impl Chart<'_> {
    /// Draws it into a file.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn draw(&self, path: &Path) -> Result<()> {
        let points = || self.curves.iter().flat_map(|curve| &curve.1);
        let range = |i: usize| points().fold([f64::INFINITY, 0.0_f64], |[least, most], p| [least.min(p[i]), most.max(p[i])]);
        let ([x0, x1], [y0, y1]) = (range(0), range(1));
        let root = SVGBackend::new(path, SIZE).into_drawing_area();
        root.fill(&WHITE).map_err(said)?;
        let mut builder = ChartBuilder::on(&root);
        builder.margin(12).x_label_area_size(42).y_label_area_size(60);
        if self.logarithmic {
            let mut chart =
                builder.build_cartesian_2d((x0 * 0.9..x1 * 1.1).log_scale().base(2.0), (y0 * 0.8..y1 * 1.25).log_scale()).map_err(said)?;
            chart.configure_mesh().x_desc(self.axes[0]).y_desc(self.axes[1]).light_line_style(TRANSPARENT).draw().map_err(said)?;
            for ((name, points), colour) in self.curves.iter().zip(COLOURS) {
                let line = LineSeries::new(points.iter().map(|p| (p[0], p[1])), colour.stroke_width(2)).point_size(3);
                chart.draw_series(line).map_err(said)?.label(name).legend(move |(x, y)| legend(x, y, colour));
            }
            chart
                .configure_series_labels()
                .border_style(BLACK.mix(0.3))
                .background_style(WHITE)
                .position(SeriesLabelPosition::UpperLeft)
                .draw()
                .map_err(said)?;
        } else {
            let mut chart = builder.build_cartesian_2d(0.0..x1 * 1.05, 0.0..y1 * 1.3).map_err(said)?;
            chart.configure_mesh().x_desc(self.axes[0]).y_desc(self.axes[1]).light_line_style(TRANSPARENT).draw().map_err(said)?;
            for ((name, points), colour) in self.curves.iter().zip(COLOURS) {
                let line = LineSeries::new(points.iter().map(|p| (p[0], p[1])), colour.stroke_width(2)).point_size(3);
                chart.draw_series(line).map_err(said)?.label(name).legend(move |(x, y)| legend(x, y, colour));
            }
            chart
                .configure_series_labels()
                .border_style(BLACK.mix(0.3))
                .background_style(WHITE)
                .position(SeriesLabelPosition::UpperLeft)
                .draw()
                .map_err(said)?;
        }
        root.present().map_err(said)
    }
}

fn legend(x: i32, y: i32, colour: RGBColor) -> PathElement<(i32, i32)> {
    PathElement::new(vec![(x, y), (x + 16, y)], colour.stroke_width(2))
}

fn said(error: impl std::fmt::Display) -> anyhow::Error {
    anyhow!("{error}")
}

/// Bars of parts, one upon the other: names of the parts from below, then of each bar its name and the parts' sizes.
///
/// # Errors
/// A file that cannot be written.
pub fn bars(path: &Path, axis: &str, parts: &[&str], bars: &[(String, Vec<f64>)]) -> Result<()> {
    let most = bars.iter().map(|bar| bar.1.iter().sum::<f64>()).fold(0.0, f64::max);
    let height = 60 + 26 * bars.len() as u32 + 60;
    let root = SVGBackend::new(path, (SIZE.0, height)).into_drawing_area();
    root.fill(&WHITE).map_err(said)?;
    let count = bars.len() as f64;
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(170)
        .build_cartesian_2d(0.0..most * 1.05, -1.5..count)
        .map_err(said)?;
    let name = |at: &f64| {
        let i = count - 1.0 - at;
        let exact = (i - i.round()).abs() < 1e-6 && i > -0.5;
        if exact { bars.get(i.round() as usize).map_or(String::new(), |bar| bar.0.clone()) } else { String::new() }
    };
    chart
        .configure_mesh()
        .x_desc(axis)
        .disable_y_mesh()
        .y_labels(bars.len() + 2)
        .y_label_formatter(&name)
        .light_line_style(TRANSPARENT)
        .draw()
        .map_err(said)?;
    for (k, (part, colour)) in parts.iter().zip(COLOURS).enumerate() {
        let boxes = bars.iter().enumerate().map(|(i, bar)| {
            let (from, to): (f64, f64) = (bar.1[..k].iter().sum(), bar.1[..=k].iter().sum());
            let middle = count - 1.0 - i as f64;
            Rectangle::new([(from, middle - 0.35), (to, middle + 0.35)], colour.filled())
        });
        chart
            .draw_series(boxes)
            .map_err(said)?
            .label(*part)
            .legend(move |(x, y)| Rectangle::new([(x, y - 4), (x + 14, y + 4)], colour.filled()));
    }
    chart
        .configure_series_labels()
        .border_style(BLACK.mix(0.3))
        .background_style(WHITE)
        .position(SeriesLabelPosition::LowerRight)
        .draw()
        .map_err(said)?;
    root.present().map_err(said)
}
