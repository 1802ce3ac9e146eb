//! The table from above: where the toys are, and where to put them.

use egui::{Color32, Sense, Ui, vec2};
use plumbline_engine::TwinCommand;
use plumbline_engine::view::ToyView;
use plumbline_model::robot::Rig;
use plumbline_widgets::overlay::Ink;
use plumbline_widgets::table_map::{Outline, Place, TableMap, TableMark, TableScene};
use plumbline_widgets::theme::{self, Role, space};

use crate::panels::PanelContext;

const MAP_HEIGHT: f32 = 190.0;
/// The part of the table that is shown, robot frame, m.
const X_M: [f64; 2] = [0.10, 0.60];
const Y_M: [f64; 2] = [-0.40, 0.40];

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let view = cx.view;
    let toys = &view.twin.toys;
    theme::group_heading(ui, "Toys");
    chips(ui, cx, toys);
    let chosen = cx.state.twin.chosen_toy.and_then(|i| toys.get(i));
    let said = match chosen {
        Some(toy) => format!("Click the table to put the {} there.", toy.name),
        None => "Choose a toy, then click the table.".to_owned(),
    };
    ui.label(theme::small(ui, said));
    let scene = scene(view.robot.rig.as_deref(), toys, chosen);
    let shown = TableMap::new("Twin's table", &scene).height(MAP_HEIGHT).show(ui);
    if let (Some([x_m, y_m]), Some(toy)) = (shown.clicked_m, chosen) {
        cx.outbox.send(TwinCommand::PlaceToy { toy: toy.name.clone(), x_m, y_m });
    }
    if let Some(toy) = chosen.filter(|toy| toy.place.is_some())
        && ui.button(format!("Put the {} away", toy.name)).clicked()
    {
        cx.outbox.send(TwinCommand::RemoveToy { toy: toy.name.clone() });
    }
}

/// One chip per toy in its color; a ring where it is put away.
fn chips(ui: &mut Ui, cx: &mut PanelContext<'_>, toys: &[ToyView]) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(space::XS, 2.0);
        ui.spacing_mut().interact_size.y = 24.0;
        ui.spacing_mut().button_padding = vec2(6.0, 2.0);
        for (i, toy) in toys.iter().enumerate() {
            let chosen = cx.state.twin.chosen_toy == Some(i);
            let where_to = if toy.place.is_some() { "on the table" } else { "put away" };
            let text = egui::RichText::new(format!("    {}", toy.name));
            let chip = ui.add(egui::Button::selectable(chosen, text).sense(Sense::click()));
            chip.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, chosen, &toy.name));
            let at = chip.rect.left_center() + vec2(12.0, 0.0);
            // A light one is seen on a light ground, too.
            let edge = egui::Stroke::new(1.0, theme::tokens(ui).text_weak);
            match toy.place {
                Some(_) => ui.painter().circle(at, 5.0, color(toy), edge),
                None => {
                    ui.painter().circle_stroke(at, 5.0, edge);
                    ui.painter().circle_stroke(at, 3.5, egui::Stroke::new(1.5, color(toy)))
                }
            };
            if chip.on_hover_text(where_to).clicked() {
                cx.state.twin.chosen_toy = (!chosen).then_some(i);
            }
        }
    });
}

fn color(toy: &ToyView) -> Color32 {
    let [r, g, b] = toy.rgb;
    Color32::from_rgb(r, g, b)
}

fn scene(rig: Option<&Rig>, toys: &[ToyView], chosen: Option<&ToyView>) -> TableScene {
    let mut scene = TableScene { x_m: X_M, y_m: Y_M, ..TableScene::new() };
    if let Some(rig) = rig {
        let screen = &rig.touchscreen;
        let (u, v) = (screen.u_axis.vector() * screen.width_m, screen.v_axis.vector() * screen.height_m);
        let origin = screen.origin.coords.coords;
        let corners = [origin, origin + u, origin + u + v, origin + v];
        scene.outlines.push(Outline {
            place: Place::Touchscreen,
            name: "touchscreen".to_owned(),
            corners_m: corners.iter().map(|corner| [corner.x, corner.y]).collect(),
        });
    }
    for toy in toys {
        let Some(place) = toy.place else { continue };
        let is_chosen = chosen.is_some_and(|chosen| chosen.name == toy.name);
        let mark = |ink, text: &str| TableMark {
            at_m: [place.coords.x, place.coords.y],
            vector_m: None,
            ink,
            text: text.to_owned(),
        };
        // The name in a color that can be read, the toy's own color on top of its dot.
        let role = if is_chosen { Role::Ink } else { Role::Weak };
        scene.marks.push(mark(role.into(), &toy.name));
        scene.marks.push(mark(Ink::Color(color(toy)), ""));
    }
    scene
}
