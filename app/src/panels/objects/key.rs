//! Which object is meant, although every pair brings new boxes.

use plumbline_engine::view::{ObjectView, SeenBox};
use plumbline_model::{ClassIndex, Eye, Pixel, Raw};

/// A box of the same class this near to where the object was is taken for the same object, pixels.
const MOVED_PX: f64 = 60.0;

/// An object by its class and where it was last seen.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectKey {
    class: ClassIndex,
    /// Name of the class, for when it is not seen any more.
    pub name: String,
    middles_px: [Option<[f64; 2]>; 2],
}

impl ObjectKey {
    /// This object.
    pub fn of(object: &ObjectView) -> Self {
        let middle = |eye| object.seen(eye).map(middle_px);
        Self { class: object.class, name: object.name.clone(), middles_px: Eye::BOTH.map(middle) }
    }

    /// Whether it is this one, exactly.
    pub fn is(&self, object: &ObjectView) -> bool {
        *self == Self::of(object)
    }

    /// The same object among these.
    pub fn find<'a>(&self, objects: &'a [ObjectView]) -> Option<&'a ObjectView> {
        let objects: Vec<&ObjectView> = objects.iter().collect();
        self.nearest(&objects).map(|i| objects[i])
    }

    /// The place of the same object in this list.
    pub fn nearest(&self, objects: &[&ObjectView]) -> Option<usize> {
        let of_class = objects.iter().enumerate().filter(|(_, object)| object.class == self.class);
        let near = of_class.map(|(i, object)| (self.moved_px(object), i));
        let nearest = near.min_by(|(a, _), (b, _)| a.total_cmp(b));
        nearest.filter(|(by_px, _)| *by_px < MOVED_PX).map(|(_, i)| i)
    }

    /// How far it would have moved, in the eye that knows; infinite if no eye does.
    fn moved_px(&self, object: &ObjectView) -> f64 {
        Eye::BOTH
            .into_iter()
            .filter_map(|eye| {
                let ([u, v], [was_u, was_v]) =
                    (object.seen(eye).map(middle_px)?, self.middles_px[eye.index()]?);
                Some((u - was_u).hypot(v - was_v))
            })
            .fold(f64::INFINITY, f64::min)
    }
}

/// The middle of a box, pixels.
pub fn middle_px(seen: &SeenBox) -> [f64; 2] {
    let Pixel::<Raw> { u_px, v_px, .. } = seen.area.middle();
    [u_px, v_px]
}

/// The object whose box in this eye is at a pixel; of several, the smallest box.
pub fn at(objects: &[ObjectView], eye: Eye, [u_px, v_px]: [f64; 2]) -> Option<&ObjectView> {
    let here = objects.iter().filter_map(|object| {
        let area = object.seen(eye)?.area;
        area.contains(&Pixel::<Raw>::new(u_px, v_px)).then(|| (area.area_px2(), object))
    });
    here.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, object)| object)
}
