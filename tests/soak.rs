//! A process that previews scene after scene keeps no more memory than it had after the first ones.
//!
//! `VELOUR_COUNT=2000 cargo test --release --test soak` loads, changes, renders and drops as many scenes.
#![cfg(target_os = "linux")]
#![allow(unsafe_code, reason = "an allocator is told of by unsafe functions")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicI64, Ordering};
use velour::render::{Renderer, Settings, Silent};
use velour::scene::{Scene, ShaderFiles};

/// The system's allocator, which counts what is in use.
struct Counting;

static IN_USE: AtomicI64 = AtomicI64::new(0);

// SAFETY: all is left to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        IN_USE.fetch_add(layout.size() as i64, Ordering::Relaxed);
        // SAFETY: the caller's promises are those that it asks for.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        IN_USE.fetch_sub(layout.size() as i64, Ordering::Relaxed);
        // SAFETY: as above.
        unsafe { System.dealloc(at, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Bytes that the process holds.
fn resident() -> f64 {
    let pages = std::fs::read_to_string("/proc/self/statm").unwrap();
    pages.split(' ').nth(1).unwrap().parse::<f64>().unwrap() * 4096.0
}

/// A preview of scene `turn`: its shader, its mesh and its messages are its own.
fn preview(turn: usize) {
    let cloth = format!(
        "surface cloth(float r = .3, string name = \"cloth {turn}\") {{ string s = format(\"%s %g\", name, floor(u * 20));
         if (u > 2) printf(\"%s\", s); Ci = sheen((.5 + {turn}e-5 + .2 * noise(P * 9)) * diffuse(N), N, color(strlen(s) * .05), r); }}"
    );
    let files = ShaderFiles::default().with_shader(&cloth).unwrap();
    let files = files.with_shader("surface sky(float x = .5) { Ci = x * (1 + I[1]) * background(); }").unwrap();
    let text = format!(
        "<World><Camera eye=\"0,1,5\" look_at=\"0,0,0\" fov=\"40\"/>
         <ShaderGroup>shader sky l;</ShaderGroup><Background resolution=\"16\"/>
         <ShaderGroup name=\"c\">shader cloth l;</ShaderGroup><Weave corner=\"-1,0,1\" edge_x=\"2,0,0\" edge_y=\"0,0,-2\" warp=\"{}\" weft=\"9\"/></World>",
        6 + turn % 5
    );
    let scene = Scene::load(&text, &[], &files).unwrap();
    let settings = Settings { width: 32, height: 16, samples: 2, threads: 2, ..Settings::default() };
    let mut renderer = Renderer::new(&scene, &settings).unwrap();
    renderer.finish(&Silent).unwrap();
    let mut camera = scene.camera;
    camera.fov += 1.0;
    renderer.set_camera(camera).unwrap();
    renderer.round_of(1, &Silent).unwrap();
    let cloth = renderer.material("c").unwrap();
    renderer.set_material(cloth, scene.materials[cloth].surface.clone()).unwrap();
    renderer.finish(&Silent).unwrap();
    assert!(renderer.picture().mean()[0] > 0.05);
}

#[test]
fn memory_stays_flat() {
    let count: usize = std::env::var("VELOUR_COUNT").ok().and_then(|text| text.parse().ok()).unwrap_or(90);
    let state = || (resident(), IN_USE.load(Ordering::Relaxed) as f64);
    (0..count / 2).for_each(preview);
    let (held, used) = state();
    (count / 2..count).for_each(preview);
    let (held_then, used_then) = state();
    let shown = [held, used, held_then, used_then].map(|bytes| format!("{:.2} MB", bytes / 1e6));
    println!(
        "{count} scenes: {} held and {} in use after half of them, {} and {} at the end",
        shown[0], shown[1], shown[2], shown[3]
    );
    // A text that no scene before has had is kept for ever, in some 100 bytes. A table of such texts grows at once to twice its size.
    let grown = used_then - used;
    assert!(grown < 200.0 * (count / 2) as f64 + 64e3, "{grown} bytes more are in use");
    // What the allocator holds of pools and stacks differs from run to run by more than a short one has; bytes in use do not.
    assert!(count < 1000 || held_then < 1.05 * held, "{held} bytes became {held_then}");
}
