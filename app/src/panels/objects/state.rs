//! How objects are looked at.

use plumbline_engine::View;
use plumbline_engine::view::ObjectView;
use plumbline_model::Eye;

use super::key::{self, ObjectKey};
use super::order::in_order;

/// How objects are looked at.
#[derive(Clone, Debug)]
pub struct ObjectsPanels {
    /// Whether boxes are drawn; nothing is detected while they are not.
    pub shown: bool,
    /// The object that was clicked.
    pub chosen: Option<ObjectKey>,
    hovered: Option<Hovered>,
    hovered_next: Option<Hovered>,
    /// Whether the threshold of each class can be moved.
    pub own_thresholds: bool,
    /// The lines of the list as they stand.
    pub listed: Vec<ObjectKey>,
}

/// An object under the pointer.
#[derive(Clone, Debug)]
struct Hovered {
    key: ObjectKey,
    /// In the list rather than in a picture.
    in_list: bool,
}

impl Default for ObjectsPanels {
    fn default() -> Self {
        Self {
            shown: true,
            chosen: None,
            hovered: None,
            hovered_next: None,
            own_thresholds: false,
            listed: Vec::new(),
        }
    }
}

impl ObjectsPanels {
    /// The object that is looked at: the one under the pointer, else the one that was clicked.
    pub fn focused<'a>(&self, view: &'a View) -> Option<&'a ObjectView> {
        self.under_pointer(view).or_else(|| self.chosen(view))
    }

    /// The object under the pointer, in a picture, a list or the scene.
    pub fn under_pointer<'a>(&self, view: &'a View) -> Option<&'a ObjectView> {
        self.hovered.as_ref().and_then(|hovered| hovered.key.find(objects(view)))
    }

    /// The object that is described: as [`Self::focused`], but pointing at a line of the list, which
    /// stands right above the description, must not move what the pointer is on its way to.
    pub fn described<'a>(&self, view: &'a View) -> Option<&'a ObjectView> {
        let in_picture = self.hovered.as_ref().filter(|hovered| !hovered.in_list);
        let hovered = in_picture.and_then(|hovered| hovered.key.find(objects(view)));
        hovered.or_else(|| self.chosen(view))
    }

    fn chosen<'a>(&self, view: &'a View) -> Option<&'a ObjectView> {
        self.chosen.as_ref().and_then(|chosen| chosen.find(objects(view)))
    }

    /// The pointer is over this place of an eye; `clicked` chooses what is there. Says whether a box
    /// took the click.
    pub fn point(&mut self, view: &View, eye: Eye, hover_px: Option<[f64; 2]>, clicked: bool) -> bool {
        let Some(at_px) = hover_px.filter(|_| self.shown) else { return false };
        let Some(object) = key::at(objects(view), eye, at_px) else { return false };
        let key = ObjectKey::of(object);
        if clicked {
            self.toggle(object);
        }
        self.hovered_next = Some(Hovered { key, in_list: false });
        true
    }

    /// A line of the list, or what stands for the object in the scene, is pointed at.
    pub fn hover(&mut self, object: &ObjectView) {
        self.hovered_next = Some(Hovered { key: ObjectKey::of(object), in_list: true });
    }

    /// Chooses an object, or lets go of it.
    pub fn toggle(&mut self, object: &ObjectView) {
        let same = self.chosen.as_ref().is_some_and(|chosen| chosen.is(object));
        self.chosen = (!same).then(|| ObjectKey::of(object));
    }

    /// Chooses the surest object of a class.
    pub fn choose_class(&mut self, view: &View, name: &str) {
        self.chosen = objects(view).iter().find(|object| object.name == name).map(ObjectKey::of);
    }

    /// At the end of a frame: what was pointed at is highlighted in the next, and the chosen object
    /// and the lines of the list are followed to where they are now.
    pub fn end_frame(&mut self, view: &View) {
        self.hovered = self.hovered_next.take();
        if let Some(object) = self.chosen(view) {
            self.chosen = Some(ObjectKey::of(object));
        }
        self.listed = in_order(&self.listed, objects(view)).into_iter().map(ObjectKey::of).collect();
    }
}

/// Everything that the detector found on the newest pair it has looked at.
pub fn objects(view: &View) -> &[ObjectView] {
    view.detect.found.as_ref().map_or(&[], |found| &found.objects)
}

/// Why the place of something that a hand holds is doubtful; `None`: none does, as far as that is known.
pub fn in_hand(view: &View, object: &ObjectView) -> Option<String> {
    let held = view.grasp.held.as_ref().filter(|held| held.object.eq_ignore_ascii_case(&object.name))?;
    Some(format!(
        "The {} hand holds it and covers a part of it: where its middle is the eyes cannot tell.",
        held.hand.name()
    ))
}
