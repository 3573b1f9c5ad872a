//! What is computed once and kept for the life of the process, because every mesh needs it again.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// Values by key.
pub(crate) struct Kept<K, V>(LazyLock<Mutex<HashMap<K, Arc<V>>>>);

impl<K: Eq + Hash + Copy, V> Kept<K, V> {
    pub const fn new() -> Self {
        Self(LazyLock::new(Mutex::default))
    }

    /// The value of a key, computed where it is not known. Threads that ask at the same time may compute it twice, and share one.
    pub fn get(&self, key: K, compute: impl FnOnce() -> V) -> Arc<V> {
        let known = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(value) = known().get(&key) {
            return Arc::clone(value);
        }
        let value = Arc::new(compute());
        Arc::clone(known().entry(key).or_insert(value))
    }
}
