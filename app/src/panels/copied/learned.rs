//! Tables of correction models, and of grasp height and yaw.

use plumbline_engine::View;

use super::{Table, degrees, meters, mm};

/// How training went, point by point.
pub fn losses(view: &View) -> Table {
    let rows = view.models.losses.iter().map(|point| {
        vec![
            point.method.name().to_owned(),
            point.member.to_string(),
            point.iteration.to_string(),
            mm(Some(point.train_rms_m)),
            mm(point.held_out_rms_m),
        ]
    });
    Table::new(&["method", "member", "iteration", "learned_from_rms_mm", "held_out_rms_mm"], rows)
}

/// All methods on the same held-out touches.
pub fn compared(view: &View) -> Table {
    let models = &view.models;
    let rows = models.comparison.iter().flat_map(|comparison| &comparison.methods).map(|compared| {
        let held_out = &compared.held_out;
        let [low_m, high_m] = held_out.mean_2d_interval_m;
        vec![
            compared.method.name().to_owned(),
            held_out.errors.count.to_string(),
            mm(Some(held_out.errors.mean_2d_m)),
            mm(Some(low_m)),
            mm(Some(high_m)),
            mm(Some(held_out.errors.rms_2d_m)),
            mm(Some(held_out.errors.rms_z_m)),
        ]
    });
    let headings =
        ["method", "touches", "mean_mm", "mean_low_95_mm", "mean_high_95_mm", "rms_mm", "rms_height_mm"];
    Table::new(&headings, rows)
}

/// The touches of the map, with the errors that its arrows are.
pub fn map(view: &View) -> Table {
    let rows = view.models.map.iter().flat_map(|map| &map.touches).map(|touch| {
        let errors = touch.before_m.iter().chain(&touch.after_m).map(|&error_m| mm(Some(error_m)));
        touch.at_m.iter().map(|&at_m| meters(at_m)).chain(errors).collect()
    });
    let headings = [
        "x_m",
        "y_m",
        "before_forward_mm",
        "before_left_mm",
        "before_up_mm",
        "after_forward_mm",
        "after_left_mm",
        "after_up_mm",
    ];
    Table::new(&headings, rows)
}

/// The points of both tables; a height has no place in height.
pub fn grasp_tables(view: &View) -> Table {
    let tables = &view.models.tables;
    let error = |errors: &[f64], i: usize| errors.get(i).copied().filter(|error| error.is_finite());
    let heights = tables.height.iter().flat_map(|height| height.points.iter().enumerate()).map(|(i, p)| {
        let off = error(&tables.height_errors_m, i);
        vec![
            "height, mm".to_owned(),
            meters(p.x_m),
            meters(p.y_m),
            String::new(),
            mm(Some(p.height_m)),
            mm(off),
        ]
    });
    let turns = tables.yaw.iter().flat_map(|yaw| yaw.points.iter().enumerate()).map(|(i, p)| {
        let off = error(&tables.yaw_errors_rad, i);
        let at = [p.x_m, p.y_m, p.z_m].map(meters);
        let [x, y, z] = at;
        vec!["yaw, deg".to_owned(), x, y, z, degrees(Some(p.yaw_rad)), degrees(off)]
    });
    Table::new(&["table", "x_m", "y_m", "z_m", "value", "off_the_others"], heights.chain(turns))
}
