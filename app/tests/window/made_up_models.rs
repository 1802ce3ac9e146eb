//! Views of correction models that no engine made; the models themselves are really trained, on
//! touches that were made up.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use plumbline_engine::View;
use plumbline_engine::models::{
    Comparison, CorrectionModel, HeightPoint, HeightTable, LossPoint, Method, Touch, TouchData, TrainOptions,
    YawPoint, YawTable, compare, train,
};
use plumbline_engine::view::{
    EarlierModel, Field, MapTouch, ModelMap, ModelsView, StepState, TablesView, TouchSession,
};
use plumbline_model::session::Touchscreen;
use plumbline_model::{Pixel, Point, Unattended};

use crate::made_up::{everything, rig};

/// A number of −1..=1 that looks random.
fn noise(index: usize) -> f64 {
    let mut x = (index as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x ^= x >> 29;
    x = x.wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x ^= x >> 32;
    (x % 20_001) as f64 / 10_000.0 - 1.0
}

pub fn screen() -> Touchscreen {
    rig().touchscreen.clone()
}

/// 80 touches in eight lines, each target twice, on the left two thirds of the screen.
pub fn data() -> TouchData {
    let screen = screen();
    let (width, height) = (f64::from(screen.width_px), f64::from(screen.height_px));
    let touch = |i: usize| {
        let (place, line) = (i / 2, i / 10);
        let u_px = width * (0.08 + 0.13 * (place % 5) as f64 + 0.03 * noise(place));
        let v_px = height * (0.08 + 0.11 * line as f64 + 0.02 * noise(place + 50));
        let pixel = Pixel::new(u_px + 2.0 * noise(i + 100), v_px + 2.0 * noise(i + 200));
        let at = screen.point_at(Pixel::new(u_px, v_px)).coords;
        let sag = 0.012 + 0.02 * (at.x - 0.3);
        let sent = Point::new(at.x + sag, at.y + 0.008 * (9.0 * at.y).sin(), at.z + 0.004 + 0.01 * at.y);
        let set = Some(format!("line {}", line + 1));
        Touch { pixel, sent, set, group: Some(format!("target {place}")), row: i }
    };
    let left_out = vec!["2 rows touched nothing".to_owned()];
    TouchData::new((0..80).map(touch).collect(), screen.clone(), left_out).expect("touches to learn from")
}

struct Learned {
    data: Arc<TouchData>,
    models: Vec<Arc<CorrectionModel>>,
    comparison: Arc<Comparison>,
    losses: Arc<[LossPoint]>,
}

fn learned() -> &'static Learned {
    static LEARNED: OnceLock<Learned> = OnceLock::new();
    LEARNED.get_or_init(|| {
        let (data, mut losses) = (data(), Vec::new());
        let options = TrainOptions { session: "touch-2026-11-21".to_owned(), ..TrainOptions::default() };
        let mut fit = |method| train(&data, method, &options, &Unattended, &mut |point| losses.push(point));
        let models: Vec<_> = Method::ALL.into_iter().map(|m| Arc::new(fit(m).expect("trains"))).collect();
        let comparison = compare(&data, &Method::ALL, &options, &Unattended).expect("compares");
        Learned { data: Arc::new(data), models, comparison: Arc::new(comparison), losses: losses.into() }
    })
}

pub fn model(method: Method) -> Arc<CorrectionModel> {
    let found = learned().models.iter().find(|model| model.method() == method);
    found.expect("all are trained").clone()
}

/// The map of a model, as the engine makes it.
pub fn map(method: Method, proposed: bool) -> Arc<ModelMap> {
    let (model, screen) = (model(method), screen());
    let corners = screen.corners().map(|corner| [corner.coords.x, corner.coords.y]);
    let range = |axis: usize| {
        let values = corners.iter().map(|corner| corner[axis]);
        let low = values.clone().fold(f64::INFINITY, f64::min);
        [low - 0.06, values.fold(f64::NEG_INFINITY, f64::max) + 0.06]
    };
    let z_m = screen.origin.coords.z;
    let field = |value: &dyn Fn(Pixel<plumbline_model::session::Screen>) -> f64| {
        let (x_m, y_m, columns) = (range(0), range(1), 33);
        let at = |range: [f64; 2], i: usize, n: usize| {
            range[0] + (range[1] - range[0]) * i as f64 / (n - 1) as f64
        };
        let nodes = (0..25).flat_map(|i| (0..columns).map(move |j| (i, j)));
        let values_m = nodes
            .map(|(i, j)| {
                let place = Point::new(at(x_m, i, 25), at(y_m, j, columns), z_m);
                Some(value(screen.pixel_at(place)))
            })
            .collect();
        Field { x_m, y_m, columns, values_m }
    };
    let shift = |pixel| (model.correct(pixel).target.coords - screen.point_at(pixel).coords).xy().norm();
    let sd = |pixel| model.correct(pixel).sd_m[0].hypot(model.correct(pixel).sd_m[1]);
    let on_table = |pixel: &Pixel<plumbline_model::session::Screen>| {
        let point = screen.point_at(*pixel).coords;
        [point.x, point.y]
    };
    let held_out = learned().comparison.of(method).expect("compared");
    let touches = learned().data.touches.iter().zip(&held_out.residuals_m).map(|(touch, after_m)| {
        let place = screen.point_at(touch.pixel).coords;
        let before = place - touch.sent.coords;
        MapTouch { at_m: [place.x, place.y], before_m: before.into(), after_m: *after_m }
    });
    Arc::new(ModelMap {
        method: Some(method),
        proposed,
        touches: touches.collect(),
        without_m: model.provenance().without.map(|errors| errors.mean_2d_m),
        border_m: model
            .border()
            .map(|border| border.rings().iter().map(|ring| ring.iter().map(on_table).collect()).collect())
            .unwrap_or_default(),
        screen_m: corners.to_vec(),
        sd: field(&sd),
        shift: field(&shift),
        mean_shift_m: (Some(0.0214), Some(0.0545)),
    })
}

pub fn sessions() -> Arc<[TouchSession]> {
    let session = |name: &str, touches, problem: Option<&str>| TouchSession {
        folder: PathBuf::from("sessions").join(name),
        started: "2026-11-21T13:02:00Z".parse().ok(),
        touches,
        problem: problem.map(str::to_owned),
    };
    Arc::from([
        session("newest", 80, None),
        session("older", 245, None),
        session("broken", 1, Some("1 touch is too few: touch at least 4 places")),
    ])
}

/// Touched, read, nothing trained.
pub fn recorded() -> ModelsView {
    ModelsView {
        sessions: sessions(),
        session: Some(sessions()[0].folder.clone()),
        data: Some(Ok(learned().data.clone())),
        tables: Arc::new(tables()),
        rig: Some(rig()),
        ..ModelsView::default()
    }
}

/// Half of the training is behind.
pub fn training() -> ModelsView {
    let losses = &learned().losses;
    let part = losses.iter().copied().filter(|point| point.iteration < 6).collect();
    ModelsView { training: true, step: StepState::Running, losses: part, ..recorded() }
}

/// All three are proposed, M1 is in use.
pub fn trained() -> ModelsView {
    ModelsView {
        losses: learned().losses.clone(),
        proposals: learned().models.clone(),
        comparison: Some(learned().comparison.clone()),
        shown: Some(Method::M3),
        map: Some(map(Method::M3, true)),
        in_use: Some(model(Method::M1)),
        earlier: Arc::from([EarlierModel {
            method: Some(Method::M2),
            accepted: "2026-11-20T13:02:00Z".parse().expect("a time"),
        }]),
        ..recorded()
    }
}

/// M3 was accepted.
pub fn in_use() -> ModelsView {
    ModelsView {
        proposals: Vec::new(),
        in_use: Some(model(Method::M3)),
        map: Some(map(Method::M3, false)),
        step: StepState::Done,
        ..trained()
    }
}

pub fn tables() -> TablesView {
    let height = |i: usize| {
        let (x_m, y_m) = (0.24 + 0.055 * (i / 6) as f64 + 0.008 * noise(i), -0.25 + 0.1 * (i % 6) as f64);
        HeightPoint { x_m, y_m, height_m: 0.04 + 0.1 * (x_m - 0.3) + 0.004 * noise(i + 30) }
    };
    let yaw = |i: usize| YawPoint {
        x_m: 0.25 + 0.07 * (i % 4) as f64,
        y_m: -0.2 + 0.13 * (i / 4 % 4) as f64,
        z_m: if i < 16 { 0.02 } else { 0.08 },
        yaw_rad: 0.3 + 0.2 * noise(i + 400),
    };
    let heights = HeightTable::new((0..24).map(height).collect()).expect("a table");
    let yaws = YawTable::new((0..32).map(yaw).collect()).expect("a table");
    let surface = heights.surface().expect("a surface");
    let (x_m, y_m, columns) = ([0.2, 0.5], [-0.35, 0.35], 29);
    let values_m = (0..17 * columns)
        .map(|i| {
            let x = x_m[0] + (x_m[1] - x_m[0]) * (i / columns) as f64 / 16.0;
            let y = y_m[0] + (y_m[1] - y_m[0]) * (i % columns) as f64 / (columns - 1) as f64;
            surface.interpolate(x, y).ok().filter(|found| found.inside).map(|found| found.value)
        })
        .collect();
    TablesView {
        height_errors_m: heights.leave_one_out().expect("errors"),
        yaw_errors_rad: yaws.leave_one_out().expect("errors"),
        height: Some(Arc::new(heights)),
        yaw: Some(Arc::new(yaws)),
        height_field: Field { x_m, y_m, columns, values_m },
        can_undo: true,
        palm: Some(([0.31, -0.1, 0.06], 0.4)),
        ..TablesView::default()
    }
}

pub fn with(models: ModelsView) -> View {
    View { models: Arc::new(models), ..everything() }
}
