//! Renders a mesh file with the defaults: MESH OUT.png [SIZE] [key=value ...]
use catoptric::{field::*, gpu::*, mesh, stam::LimitSurface};
use glam::DVec3;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let start = Instant::now();
    let args: Vec<String> = std::env::args().collect();
    let get = |key: &str| args.iter().find_map(|a| a.strip_prefix(&format!("{key}=")).map(str::to_owned));
    let size: u32 = get("size").map_or(1024, |s| s.parse().unwrap());
    let up = match get("up").as_deref() {
        Some("z") => DVec3::Z,
        _ => DVec3::Y,
    };
    let mesh = mesh::read(args[1].as_ref())?;
    println!("read {:?}", start.elapsed());
    let surface = LimitSurface::new(&mesh)?;
    println!("surface {:?}, {} patches", start.elapsed(), surface.patches().len());
    let gpu = Gpu::new()?;
    println!("gpu {:?} {}", start.elapsed(), gpu.adapter());
    let tables = gpu.upload(&surface)?;
    println!("upload {:?}, {} bytes", start.elapsed(), tables.size());
    let bounds = surface.bounds().unwrap();
    let mut camera = Camera::fit(bounds, [size, size], up);
    if let Some(zoom) = get("zoom") {
        camera.fov /= zoom.parse::<f64>()?;
    }
    if let Some(t) = get("target") {
        let v: Vec<f64> = t.split(',').map(|x| x.parse().unwrap()).collect();
        camera.target = DVec3::new(v[0], v[1], v[2]);
    }
    let light = Light::fit(bounds, camera.eye, up);
    let mut view = View::new(camera, light);
    if let Some(l) = get("level") {
        view.proxy_level = l.parse()?;
    }
    if let Some(l) = get("samples") {
        view.samples = l.parse()?;
    }
    if get("pipeline").as_deref() == Some("polygon") {
        view.pipeline = Pipeline::Polygon;
    }
    match get("pattern").as_deref() {
        Some("lattice") => view.pattern = Pattern::Lattice { width: 0.2 },
        Some("circles") => view.pattern = Pattern::Circles { radius: 0.3 },
        Some("stripes") | None => (),
        Some(file) => {
            let image = image::open(file)?.to_rgba8();
            view.pattern = Pattern::Picture(Picture { size: [image.width(), image.height()], rgba8: image.into_raw() });
        }
    }
    for _ in 0..get("repeat").map_or(0, |r| r.parse().unwrap()) {
        println!("      {:?}", gpu.render(&tables, &view)?.timings.steps);
        let image = gpu.inspect(&tables, &view)?;
        println!(
            "inspect {:?} covered {}",
            image.timings.steps,
            image.patch.iter().filter(|&&p| p != NO_PATCH).count()
        );
    }
    let frame = gpu.render(&tables, &view)?;
    println!("render {:?} {:?}", start.elapsed(), frame.timings.steps);
    image::save_buffer(&args[2], &frame.rgba8, size, size, image::ColorType::Rgba8)?;
    println!("png {:?}", start.elapsed());
    Ok(())
}
