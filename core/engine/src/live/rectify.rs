//! Rectification and disparity of a live pair.

use std::sync::Arc;

use image::GrayImage;
use plumbline_model::{Stamp, StereoFrame};
use plumbline_vision::disparity::{DisparityError, Matcher, Settings};
use plumbline_vision::rectify::{Rectifier, RectifyError};

use super::no_reading::NoView;
use super::setup::LiveSetup;
use super::view::{DisparityView, RectifiedView};
use crate::ground::stage::Stage;
use crate::ground::watched::WatchedThread;

/// A pair and what is wanted of it.
#[derive(Clone, Debug)]
pub struct RectifyInput {
    /// The pair.
    pub frame: StereoFrame,
    /// What it rests on.
    pub setup: Arc<LiveSetup>,
    /// Whether disparity is wanted too.
    pub disparity: bool,
}

/// A rectified pair and perhaps its disparity.
#[derive(Debug)]
pub struct RectifyOutput {
    /// Of which setup.
    pub generation: u64,
    /// The products, or why there are none.
    pub products: Result<(RectifiedView, Option<DisparityView>), NoView>,
}

/// Keeps maps and working memory from pair to pair.
#[derive(Default)]
pub struct RectifyStage {
    rectifier: Option<(u64, Rectifier)>,
    matcher: Option<Matcher>,
}

impl Stage for RectifyStage {
    type Input = RectifyInput;
    type Output = RectifyOutput;
    type Key = (u64, u64, bool);
    const THREAD: WatchedThread = WatchedThread::Rectify;

    fn stamp(input: &RectifyInput) -> Stamp {
        input.frame.stamp
    }

    fn key(input: &RectifyInput) -> Self::Key {
        (input.frame.stamp.seq, input.setup.generation, input.disparity)
    }

    fn process(&mut self, input: RectifyInput) -> RectifyOutput {
        RectifyOutput { generation: input.setup.generation, products: self.compute(&input) }
    }
}

impl RectifyStage {
    fn compute(&mut self, input: &RectifyInput) -> Result<(RectifiedView, Option<DisparityView>), NoView> {
        let stamp = input.frame.stamp;
        let rectifier = self.rectifier(&input.setup)?;
        let views = rectifier.rectify_rgb(&input.frame.left, &input.frame.right)?;
        let rectified = RectifiedView { stamp, left: Arc::new(views.left), right: Arc::new(views.right) };
        let disparity = if input.disparity { Some(self.disparity(input, &rectified)?) } else { None };
        Ok((rectified, disparity))
    }

    fn disparity(
        &mut self,
        input: &RectifyInput,
        views: &RectifiedView,
    ) -> Result<DisparityView, DisparityError> {
        let setup = &input.setup;
        let settings = Settings::live(setup.max_disparity_px);
        let matcher = match self.matcher.take().filter(|matcher| *matcher.settings() == settings) {
            Some(matcher) => matcher,
            None => Matcher::new(settings)?,
        };
        let matcher = self.matcher.insert(matcher);
        let gray = |image| -> GrayImage { image::imageops::grayscale(image) };
        let (left, right) = rayon::join(|| gray(&*views.left), || gray(&*views.right));
        let masks = self.rectifier.as_ref().map(|(_, rectifier)| rectifier.masks());
        let map = matcher.compute(&left, &right, masks)?;
        Ok(DisparityView {
            stamp: views.stamp,
            size_px: (map.width_px(), map.height_px()),
            values_px: map.as_slice().into(),
            focal_px: setup.pair.f_px,
            baseline_m: setup.pair.baseline_m,
            valid_fraction: map.valid_fraction(),
            measured_fraction: map.measured_fraction(),
            search_px: (0.0, f64::from(setup.max_disparity_px)),
            map: Arc::new(map),
        })
    }

    fn rectifier(&mut self, setup: &LiveSetup) -> Result<&Rectifier, RectifyError> {
        let known = self.rectifier.take().filter(|(generation, _)| *generation == setup.generation);
        let kept = match known {
            Some(kept) => kept,
            None => (setup.generation, Rectifier::new(&setup.pair)?),
        };
        Ok(&self.rectifier.insert(kept).1)
    }
}
