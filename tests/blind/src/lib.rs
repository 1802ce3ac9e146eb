//! Hides effects in the physics, writes ordinary sessions, keeps the answers apart, and scores who
//! finds them.
