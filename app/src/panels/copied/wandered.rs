//! Tables of drift and of the timeline.

use plumbline_engine::View;
use plumbline_engine::view::{Figure, TableRow};

use super::{Table, meters, mm, number};
use crate::operator::words::timeline::title;

/// The rows of the table from near to far, each with what is off there over time.
pub fn course(view: &View) -> Table {
    let names = TableRow::ALL.map(TableRow::name);
    let mut headings = vec!["since_start_s".to_owned()];
    for what in ["off", "along_sight", "across_sight"] {
        headings.extend(names.iter().map(|name| format!("{name}_{what}_mm")));
    }
    let headings: Vec<&str> = headings.iter().map(String::as_str).collect();
    let points = view.drift.course.iter().flat_map(|course| &course.points);
    let rows = points.map(|point| {
        let lengths = point.off_m.iter().chain(&point.along_m).chain(&point.across_m);
        let lengths = lengths.map(|&length_m| mm(Some(length_m)));
        std::iter::once(number(Some(point.at_s), 1.0, 1)).chain(lengths).collect()
    });
    Table::new(&headings, rows)
}

pub fn table(view: &View) -> Table {
    let places = view.drift.course.iter().flat_map(|course| course.table.iter().flatten());
    let rows = places.map(|place| {
        let at = place.at_m.iter().map(|&at_m| meters(at_m));
        let error =
            place.error_m.iter().chain([&place.along_m, &place.across_m]).map(|&off_m| mm(Some(off_m)));
        at.chain(error).collect()
    });
    let headings =
        ["x_m", "y_m", "z_m", "off_x_mm", "off_y_mm", "off_z_mm", "along_sight_mm", "across_sight_mm"];
    Table::new(&headings, rows)
}

/// Every place of the evaluations that are shown.
pub fn grid(view: &View) -> Table {
    let figures = view.drift.grid.figures.iter().flatten();
    let judged = figures.filter_map(|figure| Some((figure, figure.judged.as_ref()?.as_ref().ok()?)));
    let rows = judged.flat_map(|(figure, judged)| judged.places.iter().map(move |place| (figure, place)));
    let rows = rows.map(|(figure, place)| {
        let (target, estimate) = (place.target.coords, place.estimate.coords);
        let mut row = vec![figure.title.clone()];
        row.extend([target.x, target.y, target.z, estimate.x, estimate.y, estimate.z].map(meters));
        row.push(mm(Some(place.error_m().norm())));
        row
    });
    let headings = [
        "evaluation",
        "target_x_m",
        "target_y_m",
        "target_z_m",
        "estimate_x_m",
        "estimate_y_m",
        "estimate_z_m",
        "off_on_the_table_mm",
    ];
    Table::new(&headings, rows)
}

fn error(figure: Option<Figure>) -> String {
    match figure {
        Some(Figure::Meters(length_m)) => mm(Some(length_m)),
        Some(Figure::Pixels(px)) => number(Some(px), 1.0, 4),
        Some(Figure::Share(share)) => number(Some(share), 100.0, 1),
        None => String::new(),
    }
}

fn unit(figure: Option<Figure>) -> String {
    match figure {
        Some(Figure::Meters(_)) => "mm",
        Some(Figure::Pixels(_)) => "px",
        Some(Figure::Share(_)) => "%",
        None => "",
    }
    .to_owned()
}

/// The entries, oldest first; `only`: those with these numbers.
pub fn timeline(view: &View, only: Option<&[u64]>) -> Table {
    let entries = view.timeline.entries.iter();
    let entries = entries.filter(|entry| only.is_none_or(|only| only.contains(&entry.number)));
    let rows = entries.map(|entry| {
        vec![
            entry.number.to_string(),
            entry.at.to_string(),
            entry.subject.name().to_owned(),
            title(entry),
            error(entry.before),
            error(entry.after),
            unit(entry.after.or(entry.before)),
            entry.basis.clone(),
        ]
    });
    Table::new(&["number", "at", "of", "what", "before", "after", "unit", "on_what"], rows)
}

pub fn in_use(view: &View) -> Table {
    let rows = view.timeline.in_use.iter().map(|now| {
        vec![
            now.subject.name().to_owned(),
            now.title.clone(),
            now.since.map_or_else(String::new, |since| since.to_string()),
            error(now.figure),
            unit(now.figure),
        ]
    });
    Table::new(&["of", "in_use", "since", "error", "unit"], rows)
}
