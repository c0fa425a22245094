// A face in a studio: key light with a soft shadow, fill, rim, light from the room; GGX for what
// shines, pores and weather for stone, fibres and fuzz for felt, warm edges of the light for what it
// goes under, the lamps themselves in eyes. Everything is in linear light until the last line.
in vec3 v_position, v_normal, v_rest;
in float v_openness;
#ifdef FUZZ
in float v_layer;
#endif
#ifdef OWN_COLOURS
in vec3 v_colour;
uniform bool has_own_colours; // v_colour instead of base_colour
#endif

uniform vec3 eye;            // mm
uniform vec4 base_colour;    // linear
uniform float roughness, metallic;
uniform float softness, coat; // light goes under it; a wet film over it
uniform float cornea;       // 0..1: a clear ball over it, in which the lamps are seen
uniform float bounce; // share of the key light that reaches it in the shadow too: in a mouth
uniform float grain_scale;   // 1 / height of the face, 1/mm
uniform vec3 light_direction[3]; // key, fill, rim: towards the light
uniform mat4 shadow_projection;  // mm to 0..1
uniform sampler2DShadow shadow_map;
uniform float shadow_texel_mm, shadow_reach_texels;
uniform ivec2 origin; // of the rectangle, pixels of the framebuffer
uniform int side;     // of a pixel of the picture, in those: 1 or 2
out vec4 colour;

uniform vec3 light_colour[3]; // key, fill, rim: linear
uniform float room;           // how much light comes from all sides
const vec3 sky = vec3(0.255, 0.285, 0.335), ground = vec3(0.095, 0.083, 0.072);

#ifdef PAINTED
in vec4 v_tint;
in vec2 v_uv;
uniform sampler2D base_map, normal_map, emission_map, rough_metal_map;
uniform vec3 uv_transform[8]; // two rows of each, from v_uv
uniform vec3 emission; // linear
uniform float normal_scale;
uniform vec3 shade;   // toon: linear
uniform vec2 toon;    // shift, toony
uniform vec2 alpha_range;

vec2 uv_of(int map)
{
    vec3 at = vec3(v_uv, 1.0);
    return vec2(dot(uv_transform[2 * map], at), dot(uv_transform[2 * map + 1], at));
}

#ifdef NORMAL_MAP
// The normal map, in a frame made of how position and coordinates change from pixel to pixel.
vec3 bend(vec3 normal)
{
    vec2 uv = uv_of(1);
    vec3 px = dFdx(v_position), py = dFdy(v_position);
    vec2 ux = dFdx(uv), uy = dFdy(uv);
    vec3 along = cross(py, normal) * ux.x + cross(normal, px) * uy.x;
    vec3 down = cross(py, normal) * ux.y + cross(normal, px) * uy.y;
    float size = max(dot(along, along), dot(down, down));
    if (!(size > 1e-20))
        return normal;
    vec3 bump = texture(normal_map, uv).xyz * 2.0 - 1.0;
    bump.xy *= normal_scale;
    return normalize((along * bump.x - down * bump.y) * inversesqrt(size) + normal * max(bump.z, 0.05));
}
#endif
#endif

#if defined(STONE) || defined(FELT)
float lattice(ivec3 p)
{
    uint h = scramble(uint(p.x) * 0x8da6b343u + uint(p.y) * 0xd8163841u + uint(p.z) * 0xcb1ab31fu);
    return float(h & 0xffffu) / 32767.5 - 1.0;
}

// Value noise -1..1 and its gradient (yzw).
vec4 noise(vec3 p)
{
    ivec3 i = ivec3(floor(p));
    vec3 f = p - floor(p);
    vec3 u = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    vec3 du = 30.0 * f * f * (f * (f - 2.0) + 1.0);
    float a = lattice(i), b = lattice(i + ivec3(1, 0, 0));
    float c = lattice(i + ivec3(0, 1, 0)), d = lattice(i + ivec3(1, 1, 0));
    float e = lattice(i + ivec3(0, 0, 1)), g = lattice(i + ivec3(1, 0, 1));
    float h = lattice(i + ivec3(0, 1, 1)), k = lattice(i + ivec3(1, 1, 1));
    float kx = b - a, ky = c - a, kz = e - a;
    float kxy = a - b - c + d, kyz = a - c - e + h, kzx = a - b - e + g;
    float kxyz = -a + b + c - d + e - g - h + k;
    float value = a + kx * u.x + ky * u.y + kz * u.z + kxy * u.x * u.y + kyz * u.y * u.z +
                  kzx * u.z * u.x + kxyz * u.x * u.y * u.z;
    vec3 slope = du * (vec3(kx, ky, kz) + kxy * u.yxz * vec3(1, 1, 0) + kyz * vec3(0, u.z, u.y) +
                       kzx * vec3(u.z, 0, u.x) + kxyz * vec3(u.y * u.z, u.z * u.x, u.x * u.y));
    return vec4(value, slope);
}

// Turned out of the axes, so that no lattice shows. The way back: v * turned.
const mat3 turned = mat3(0.80, -0.60, 0.0, 0.36, 0.48, 0.8, -0.48, -0.64, 0.6);

// How much of a pattern of so large cells the pixels can show.
float visibility(vec3 p)
{
    return 1.0 - smoothstep(0.35, 0.9, float(side) * length(fwidth(p)));
}

// Adds one size of grain, unless it is finer than the pixels can show.
void add_grain(float cells, float tint, float slope, inout vec4 grain)
{
    vec3 p = turned * v_rest * grain_scale * cells;
    float visible = visibility(p);
    if (visible <= 0.0)
        return;
    vec4 n = noise(p);
    grain += visible * vec4(tint * n.x, slope * (n.yzw * turned));
}
#endif

#ifdef STONE
// Holes that gas left: at most one ball in each cell, wholly inside it.
void add_pores(vec3 p, float share, float dark, float slope, inout vec4 grain)
{
    float visible = visibility(1.4 * p);
    ivec3 cell = ivec3(floor(p));
    uint h = scramble(uint(cell.x) * 0x8da6b343u + uint(cell.y) * 0xd8163841u + uint(cell.z) * 0xcb1ab31fu);
    if (visible <= 0.0 || float(h & 255u) >= 256.0 * share)
        return;
    vec3 place = vec3(float((h >> 8) & 255u), float((h >> 16) & 255u), float(h >> 24)) / 255.0;
    vec3 away = fract(p) - mix(vec3(0.32), vec3(0.68), place);
    float radius = mix(0.12, 0.32, fract(place.x * 7.0 + place.y * 3.0));
    float share_of_radius = length(away) / radius;
    float depth = 1.0 - smoothstep(0.45, 1.0, share_of_radius);
    float wall = depth * (1.0 - depth) * 4.0;
    grain.x -= visible * dark * depth;
    grain.yzw += visible * slope * wall * ((away / max(length(away), 1e-4)) * turned);
}

// Tuff that has stood in the rain: ochre and grey, streaks, pale crusts where it looks up.
vec3 weather(vec3 base, vec3 normal)
{
    vec3 p = turned * v_rest * grain_scale, upright = v_rest * grain_scale;
    vec4 broad = noise(p * 3.3 + 4.0);
    vec3 bent = p + 0.05 * broad.yzw;
    vec3 tone = mix(vec3(1.07, 0.99, 0.88), vec3(0.88, 0.94, 0.99), smoothstep(-0.6, 0.6, broad.x + 0.4 * noise(bent * 11.0).x));
    float wavy = noise(bent * 9.0).x;
    float streak = noise(upright * vec3(30.0, 2.6, 30.0) + wavy).x;
    float wash = smoothstep(0.05, 0.9, streak) * (1.0 - 0.7 * abs(normal.y));
    float crust = smoothstep(0.22, 0.65, wavy + 0.45 * noise(bent * 38.0).x) * smoothstep(-0.4, 0.5, normal.y);
    return mix(base * tone * (1.0 - 0.22 * wash), vec3(0.38, 0.385, 0.31), 0.34 * crust);
}
#endif

#ifdef FELT
// Fibres that lie across each other: the crests of a noise that is drawn out one way and bent.
void add_fibres(vec3 p, vec3 stretch, inout vec4 grain)
{
    float visible = visibility(p * 0.8);
    if (visible <= 0.0)
        return;
    vec4 n = noise(p * stretch);
    float crest = 1.0 - abs(n.x);
    crest *= crest;
    grain.x += visible * 0.17 * (crest - 0.45);
    grain.yzw -= visible * 0.10 * crest * sign(n.x) * ((n.yzw * stretch) * turned);
}
#endif

// An even disc (golden angle).
#ifdef LLVMPIPE
// Where four pixels of the framebuffer make one of the picture, each looks at two of the places.
const int tap_count = 2;
vec2 tap(int i)
{
    bvec2 odd = notEqual(ivec2(gl_FragCoord.xy) & 1, ivec2(0));
    if (i == 0)
        return odd.y ? (odd.x ? vec2(0.4024, 0.5249) : vec2(0.0489, -0.5569))
                     : (odd.x ? vec2(-0.3193, 0.2925) : vec2(0.2500, 0.0000));
    return odd.y ? (odd.x ? vec2(-0.4463, -0.8593) : vec2(-0.2340, 0.8705))
                 : (odd.x ? vec2(0.6996, -0.4450) : vec2(-0.7385, -0.1306));
}
#else
const int tap_count = 8;
const vec2 taps[tap_count] = vec2[tap_count](
    vec2(0.2500, 0.0000), vec2(-0.3193, 0.2925), vec2(0.0489, -0.5569), vec2(0.4024, 0.5249),
    vec2(-0.7385, -0.1306), vec2(0.6996, -0.4450), vec2(-0.2340, 0.8705), vec2(-0.4463, -0.8593));
vec2 tap(int i)
{
    return taps[i];
}
#endif

// How much of the key light comes by what is near. width: of the edge of a shadow, 1: as the lamp is;
// count: of places looked at.
float key_visibility(vec3 normal, float width, int count)
{
    float facing = dot(normal, light_direction[0]);
    float slant = sqrt(max(0.0, 1.0 - facing * facing));
    float reach_texels = shadow_reach_texels * width;
    vec3 from = v_position + normal * shadow_texel_mm * (1.0 + 0.8 * reach_texels * slant);
    vec3 place = (shadow_projection * vec4(from, 1.0)).xyz;
    vec2 reach = reach_texels / vec2(textureSize(shadow_map, 0));
    float seen = 0.0;
    for (int i = 0; i < count; ++i)
        seen += texture(shadow_map, vec3(place.xy + tap(i) * reach, place.z));
    return seen / float(count);
}

float fifth_power(float x)
{
    float square = x * x;
    return square * square * x;
}

// Light from the room that lids, brows and a nose keep from what they stand over.
float contact(vec3 normal)
{
#if defined(FELT)
    return mix(0.58, 1.0, key_visibility(normal, 3.2, (tap_count + 1) / 2));
#elif defined(STONE) || defined(PAINTED)
    return 1.0;
#else
    return cornea > 0.0 ? mix(0.42, 1.0, key_visibility(normal, 3.2, (tap_count + 1) / 2)) : 1.0;
#endif
}

// How far each colour of the light reaches around the edge of the lit side: the lights are large,
// and under a soft skin red goes furthest.
vec3 light_wrap()
{
#ifdef FELT
    return vec3(0.34, 0.30, 0.28);
#else
    return vec3(0.12) + softness * vec3(0.30, 0.10, 0.06);
#endif
}

float shine(vec3 normal, vec3 to_eye, vec3 to_light, float n_l, float rough)
{
    float n_v = max(dot(normal, to_eye), 1e-3);
    float n_h = max(dot(normal, normalize(to_light + to_eye)), 0.0);
    float a = rough * rough, a2 = a * a;
    float spread = n_h * n_h * (a2 - 1.0) + 1.0;
    return a2 / (3.14159265 * spread * spread) * 0.5 / mix(2.0 * n_l * n_v, n_l + n_v, a) * n_l;
}

// What a light sends to the eye (GGX, Smith, Schlick).
vec3 reflect_light(vec3 normal, vec3 to_eye, vec3 to_light, vec3 diffuse, vec3 mirror, float rough)
{
    float facing = dot(normal, to_light), n_l = max(facing, 0.0);
    float v_h = max(dot(to_eye, normalize(to_light + to_eye)), 0.0);
    vec3 fresnel = mirror + (1.0 - mirror) * fifth_power(1.0 - v_h), wrap = light_wrap();
    vec3 under = max((facing + wrap) / ((1.0 + wrap) * (1.0 + wrap)), 0.0);
    vec3 out_light = diffuse * (1.0 - fresnel) * under / 3.14159265 +
                     fresnel * shine(normal, to_eye, to_light, n_l, rough);
#ifdef FELT
    // Fibres that stand up at the edge catch the light from behind too.
    float away = 1.0 - max(dot(normal, to_eye), 0.0);
    out_light += (0.75 * diffuse + 0.035) * away * away * (0.35 + 0.65 * max(facing + 0.4, 0.0)) * 0.6;
#else
    if (coat > 0.0)
        out_light += coat * (0.04 + 0.96 * fifth_power(1.0 - v_h)) * shine(normal, to_eye, to_light, n_l, 0.22);
#endif
    return out_light;
}

#if !defined(FELT) && !defined(STONE) && !defined(PAINTED)
// The key lamp and, fainter, the fill in a wet ball: sheets of light with soft edges.
vec3 lamps_in(vec3 normal, vec3 to_eye)
{
    vec3 seen = reflect(-to_eye, normal);
    float key = smoothstep(0.895, 0.925, dot(seen, light_direction[0]));
    float fill = smoothstep(0.955, 0.985, dot(seen, light_direction[1]));
    return key * light_colour[0] * 0.30 + fill * light_colour[1] * 0.8;
}
#endif

// The room: light from above and a little from the floor, seen dully in what shines.
vec3 reflect_room(vec3 normal, vec3 to_eye, vec3 diffuse, vec3 mirror, float rough, float open)
{
    vec3 around = mix(ground, sky, 0.5 + 0.5 * normal.y);
    vec3 seen_direction = reflect(-to_eye, normal);
    float edge = mix(0.15, 1.0, rough);
    vec3 seen = mix(ground * 0.6, sky * 1.6, smoothstep(-edge, edge, seen_direction.y));
    vec3 r = max(vec3(1.0 - rough), mirror) - mirror;
    vec3 fresnel = mirror + r * fifth_power(1.0 - max(dot(normal, to_eye), 0.0));
    return (diffuse * around + fresnel * seen * mix(1.0, 0.45, rough) * open) * open;
}

// Straight up to `knee`, then a shoulder towards 1; by the strongest channel, so hues stay.
vec3 expose(vec3 light)
{
    const float knee = 0.5;
    float peak = max(light.r, max(light.g, light.b));
    if (peak <= knee)
        return light;
    float over = (peak - knee) / (1.0 - knee);
    return light * ((knee + (1.0 - knee) * over / (1.0 + over)) / peak);
}

void main()
{
    vec3 to_eye = normalize(eye - v_position);
    vec3 normal = length(v_normal) > 1e-6 ? normalize(v_normal) : to_eye;
    bool is_front = gl_FrontFacing;
#ifdef FUZZ
    is_front = true; // what is seen of it is the inside of a shell around the felt
#endif
    if (!is_front)
        normal = -normal;
    float open = is_front ? smoothstep(0.0, 1.0, clamp(v_openness, 0.0, 1.0)) : 0.6;
    float rough = clamp(roughness, 0.12, 1.0);
    vec3 base = base_colour.rgb;
#ifdef OWN_COLOURS
    base = has_own_colours ? v_colour : base;
#endif
    float shown_alpha = base_colour.a, metal = metallic;
#ifdef PAINTED
    vec4 paint = v_tint * texture(base_map, uv_of(0));
    base *= paint.rgb;
    shown_alpha *= paint.a;
#endif
#ifdef NORMAL_MAP
    normal = bend(normal);
#endif
#ifdef EMISSION
    vec3 glow = emission * texture(emission_map, uv_of(2)).rgb;
#endif
#ifdef ROUGH_METAL
    vec4 kind = texture(rough_metal_map, uv_of(3));
    rough = clamp(roughness * kind.g, 0.12, 1.0);
    metal *= kind.b;
#endif
#ifdef CUT
    if (shown_alpha < alpha_range.x || shown_alpha >= alpha_range.y)
        discard;
    shown_alpha = alpha_range.y < 1.5 ? shown_alpha : 1.0; // what is drawn as solid is
#endif
#ifdef FLAT
    colour = vec4(encode_srgb(base + glow), shown_alpha);
#elif defined(TOON)
    // VRMC_materials_mtoon: one step, from the shade's colour to the base's
    float facing = dot(normal, light_direction[0]) * key_visibility(normal, 1.0, tap_count) + toon.x;
    float lit = clamp((facing + 1.0 - toon.y) / max(2.0 - 2.0 * toon.y, 1e-3), 0.0, 1.0);
    colour = vec4(encode_srgb(mix(shade * paint.rgb, base, lit) + glow), shown_alpha);
#else

#ifdef STONE
    vec4 grain = vec4(0.0);
    add_grain(5.0, 0.07, 0.01, grain);
    add_grain(24.0, 0.06, 0.03, grain);
    add_grain(90.0, 0.08, 0.085, grain);
    add_grain(230.0, 0.12, 0.10, grain);
    vec3 p = turned * v_rest * grain_scale;
    add_pores(p * 34.0, 0.5, 0.50, 0.5, grain);
    add_pores(p.zxy * 78.0 + 5.0, 0.6, 0.42, 0.4, grain);
    base = weather(base, normal) * max(1.0 + grain.x, 0.2) * mix(0.5, 1.06, open); // dirt stays where no hand gets
    normal = normalize(normal - (grain.yzw - normal * dot(grain.yzw, normal)));
#endif
#ifdef FUZZ
    // A fibre is where the noise is high; fewer are as long as the layer is high.
    vec3 hair = turned * v_rest * grain_scale;
    float nap = 0.45 * noise(hair * 110.0).x + 0.75 * noise(hair.zxy * 310.0).x;
    if (nap < mix(-0.95, 0.5, v_layer))
        discard;
    normal = normalize(normal - to_eye * (dot(normal, to_eye) - 0.25)); // the fibres are seen from the side
    open = max(open, 0.7);
#endif
#ifdef FELT
    vec4 grain = vec4(0.0);
    vec3 p = turned * v_rest * grain_scale;
    vec4 broad = noise(p * 9.0);
    vec3 bent = p * 115.0 + 1.4 * broad.yzw;
    grain += vec4(0.07, vec3(0.012)) * vec4(broad.x, broad.yzw * turned);
    add_grain(58.0, 0.10, 0.022, grain); // flocks, seen from afar too
    add_grain(150.0, 0.16, 0.05, grain);
    add_fibres(bent, vec3(1.0, 0.30, 0.62), grain);
    base *= max(1.0 + grain.x, 0.2) * mix(0.62, 1.05, open);
    normal = normalize(normal - (grain.yzw - normal * dot(grain.yzw, normal)));
#endif

#if defined(STONE) || defined(FELT)
    vec3 mirror = vec3(0.015);
#else
    vec3 mirror = mix(vec3(0.04), base, metal);
#endif
    vec3 diffuse = base * (1.0 - metal);
    float visible[3] = float[3](max(key_visibility(normal, 1.0, tap_count), bounce), mix(0.35, 1.0, open), open);
    vec3 light = room * reflect_room(normal, to_eye, diffuse, mirror, rough, mix(0.12, 1.0, open) * contact(normal));
    for (int i = 0; i < 3; ++i)
        light += visible[i] * light_colour[i] *
                 reflect_light(normal, to_eye, light_direction[i], diffuse, mirror, rough);
#if !defined(FELT) && !defined(STONE) && !defined(PAINTED)
    if (cornea > 0.0)
        light += cornea * mix(0.25, 1.0, visible[0]) * lamps_in(normal, to_eye);
#endif
#ifdef EMISSION
    light += glow;
#endif
    colour = vec4(encode_srgb(expose(light)) + dither((ivec2(gl_FragCoord.xy) - origin) >> (side - 1)), shown_alpha);
#endif
}
