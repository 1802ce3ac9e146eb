//! Physical effects that make measurement disagree with the model, and what a plan of touches
//! can tell of them.
