//! The way from the twin's world to the source thread that shows its eyes.

use std::sync::{Arc, Mutex, PoisonError};

use plumbline_hardware::{
    Opener, RetryPolicy, Retrying, SourceError, SourceOptions, SourceSpec, StereoSource, open_retrying,
};
use plumbline_twin::SceneSource;
use plumbline_twin::eyes::{TwinEyes, TwinEyesOptions};

use crate::ground::watched::MadeUpEyes;

/// Holds the running twin's world, if there is one.
#[derive(Clone, Default)]
pub struct TwinEyesPlug {
    scene: Arc<Mutex<Option<SceneSource>>>,
    /// Eyes of a test, in place of the twin's.
    made_up: Option<MadeUpEyes>,
}

impl TwinEyesPlug {
    /// Nothing runs yet; a test may have eyes of its own.
    pub fn new(made_up: Option<MadeUpEyes>) -> Self {
        Self { made_up, ..Self::default() }
    }

    /// Another twin runs, or none.
    pub fn set(&self, scene: Option<SceneSource>) {
        *self.scene.lock().unwrap_or_else(PoisonError::into_inner) = scene;
    }

    fn open(&self) -> Result<Box<dyn StereoSource>, SourceError> {
        if let Some(eyes) = &self.made_up {
            return Ok(eyes());
        }
        let scene = self.scene.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let scene = scene.ok_or(SourceError::TwinNotRunning)?;
        let look = move || scene.newest();
        let eyes = TwinEyes::open(Arc::new(look), TwinEyesOptions::default());
        Ok(Box::new(eyes.map_err(|error| SourceError::Lost { reason: error.to_string() })?))
    }

    /// Opens the twin's eyes itself and everything else as usual.
    pub fn opener(&self) -> Opener {
        let plug = self.clone();
        Box::new(move |spec: &SourceSpec, options: &SourceOptions| match spec {
            SourceSpec::Twin => {
                let plug = plug.clone();
                Retrying::open(move || plug.open(), RetryPolicy::default())
            }
            other => open_retrying(other, options),
        })
    }
}
