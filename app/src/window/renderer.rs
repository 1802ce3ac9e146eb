//! Which of eframe's renderers draws the window.
//!
//! On a graphics card wgpu is best. Without one, wgpu on the CPU's Vulkan needs about five times
//! the processor time of OpenGL on the CPU, so then OpenGL (glow) draws.

use std::time::Duration;

use clap::ValueEnum;

/// What the operator asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum RendererChoice {
    /// wgpu on a graphics card, glow without one.
    #[default]
    Auto,
    /// wgpu, wherever it runs.
    Wgpu,
    /// OpenGL.
    Glow,
}

/// Something that can draw.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Adapter {
    /// Its name, as its driver gives it.
    pub name: String,
    /// Vulkan, Gl, …
    pub backend: String,
    /// Whether it is a processor that pretends to be a graphics card.
    pub is_cpu: bool,
}

/// The renderer and why it was taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chosen {
    /// For eframe.
    pub renderer: eframe::Renderer,
    /// A sentence for the log and for `doctor`.
    pub reason: String,
    /// Whether a graphics card draws, as far as is known.
    pub has_card: bool,
}

impl Chosen {
    /// News of the engine may wait this long before the window is drawn again. Where the processor
    /// draws, each picture of the window costs it 30 ms, which live views and the twin need too.
    /// What the operator does is shown at once all the same.
    pub fn news_may_wait(&self) -> Duration {
        if self.has_card { Duration::ZERO } else { Duration::from_millis(80) }
    }
}

/// Looks for adapters; takes about 0.1 s. None found is an empty list, never an error.
pub fn adapters() -> Vec<Adapter> {
    // Only Vulkan: OpenGL adapters need the display that eframe opens later.
    let mut wanted = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    wanted.backends = wgpu::Backends::VULKAN;
    let instance = wgpu::Instance::new(wanted);
    let found = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN));
    found
        .iter()
        .map(|adapter| {
            let info = adapter.get_info();
            Adapter {
                name: info.name,
                backend: format!("{:?}", info.backend),
                is_cpu: info.device_type == wgpu::DeviceType::Cpu,
            }
        })
        .collect()
}

/// Chooses among what was found.
pub fn choose(choice: RendererChoice, adapters: &[Adapter]) -> Chosen {
    let has_card = adapters.iter().any(|adapter| !adapter.is_cpu);
    let chosen = |renderer, reason: String| Chosen { renderer, reason, has_card };
    match choice {
        RendererChoice::Wgpu => chosen(eframe::Renderer::Wgpu, "wgpu, as asked".to_owned()),
        RendererChoice::Glow => chosen(eframe::Renderer::Glow, "OpenGL, as asked".to_owned()),
        RendererChoice::Auto => match adapters.iter().find(|adapter| !adapter.is_cpu) {
            Some(card) => chosen(eframe::Renderer::Wgpu, format!("wgpu on {} ({})", card.name, card.backend)),
            None if adapters.is_empty() => {
                chosen(eframe::Renderer::Glow, "OpenGL: no Vulkan adapter was found".to_owned())
            }
            None => chosen(
                eframe::Renderer::Glow,
                "OpenGL: the only Vulkan adapter is the processor, which draws OpenGL faster".to_owned(),
            ),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn adapter(is_cpu: bool) -> Adapter {
        Adapter { name: "test".to_owned(), backend: "Vulkan".to_owned(), is_cpu }
    }

    #[test]
    fn a_graphics_card_is_preferred_to_the_processor() {
        let chosen = choose(RendererChoice::Auto, &[adapter(true), adapter(false)]);
        assert_eq!(chosen.renderer, eframe::Renderer::Wgpu);
    }

    #[test]
    fn without_a_card_opengl_draws() {
        assert_eq!(choose(RendererChoice::Auto, &[adapter(true)]).renderer, eframe::Renderer::Glow);
        assert_eq!(choose(RendererChoice::Auto, &[]).renderer, eframe::Renderer::Glow);
    }

    #[test]
    fn news_wait_only_where_the_processor_draws() {
        assert!(choose(RendererChoice::Auto, &[adapter(true)]).news_may_wait() > Duration::ZERO);
        assert_eq!(choose(RendererChoice::Auto, &[adapter(false)]).news_may_wait(), Duration::ZERO);
    }

    #[test]
    fn the_operator_has_the_last_word() {
        assert_eq!(choose(RendererChoice::Wgpu, &[]).renderer, eframe::Renderer::Wgpu);
        assert_eq!(choose(RendererChoice::Glow, &[adapter(false)]).renderer, eframe::Renderer::Glow);
    }
}
