// velour's oslutil.h: lines of a mesh, and text drawn by a shader.

#ifndef OSLUTIL_H
#define OSLUTIL_H

// 1 on the edges of what is shaded, 0 between. The edges are those of `edge_type`: "polygons", "triangles" or "patches", whose
// corners the host gives as the attribute "geom:trianglevertices" or the like; without them there is no edge. The width counts in
// pixels where `raster` is true, else in units of the scene.
float wireframe(string edge_type, float line_width, int raster)
{
    point corners[4];
    int count = 0;
    if (edge_type == "triangles") {
        point three[3];
        if (getattribute("geom:trianglevertices", three)) {
            count = 3;
            for (int i = 0; i < 3; ++i)
                corners[i] = three[i];
        }
    } else {
        int sides = 0;
        if (getattribute("geom:numpolyvertices", sides) && sides > 2 && sides < 5
            && getattribute("geom:polyvertices", corners))
            count = sides;
    }
    float pixel = (length(Dx(P)) + length(Dy(P))) / 2;
    float width = raster ? line_width * pixel : line_width;
    for (int i = 0; i < count; ++i) {
        vector along = normalize(corners[(i + 1) % count] - corners[i]);
        if (length(cross(along, P - corners[i])) < width / 2)
            return 1;
    }
    return 0;
}

float wireframe(string edge_type, float line_width) { return wireframe(edge_type, line_width, 1); }
float wireframe(string edge_type) { return wireframe(edge_type, 1, 1); }
float wireframe() { return wireframe("polygons", 1, 1); }

// 1 where a text has a dot, 0 elsewhere. A letter is a cell 8 wide and 14 high: five dots by seven of double height, from s = 1, t = 0 at
// the upper left of the first. Where `wrap_s` or `wrap_t` is true the text comes again and again, shifted by its hash where `jitter` is
// true.
float draw_string(string str, float s, float t, int wrap_s, int wrap_t, int jitter)
{
    int wrapped(int x, int size) { return ((x % size) + size) % size; }
    int dot_of(int letter, int column, int row)
    {
        // Each character is a row of five dots, the leftmost the highest bit, from 0 on; seven make a letter, from ! on.
        string font =
            "4444404::00000::O:O::4?D>5N4HI248C3<BD8EB=44000002488842842224804E>E40044O4400000448000O000000000411248@@>ACEIA>"
            "4<4444>>A168@ON11>11N26:BO22O@N11A>68@NAA>O124444>AA>AA>>AA?12<00400400040448248@84200O0O008421248>A16404>AGEF@?"
            "4:AAOAANAANAAN>A@@@A>NAAAAANO@@N@@OO@@N@@@>A@GAA>AAAOAAA>44444>72222B<ABDHDBA@@@@@@OAKEEAAAAIECAAA>AAAAA>NAAN@@@"
            ">AAAEB=NAANDBA?@@>11NO444444AAAAAA>AAAAA:4AAAEEKAAA:4:AAAA:4444O1248@O>88888>@@84211>22222>4:A0000000000O8400000"
            "00>1?A?@@NAAAN00?@@@?11?AAA?00>AO@?698L8880?AA?1>@@NAAAA40<444>20622B<@@BDHDB<44444>00JEEEE00NAAAA00>AAA>0NAAN@@"
            "0?AA?1100GH@@@00?@>1N88L889600AAAA?00AAA:400AAEE:00A:4:A0AAA?1>00O248O34484434444444H44244H008E200";
        int place = 7 * (letter - 33) + row;
        int inside = letter > 32 && letter < 127 && column >= 0 && column < 5 && row >= 0 && row < 7;
        return inside ? (getchar(font, place) - 48 >> (4 - column)) & 1 : 0;
    }
    int seed = jitter ? hash(str) : 0;
    int x = (int)floor(s);
    int y = (int)floor(t);
    if (wrap_s)
        x = wrapped(x + (seed & 15), strlen(str) * 8 + 14);
    if (wrap_t)
        y = wrapped(y + ((seed >> 16) & 15), 28);
    int outside = x < 0 || y < 0 || x >= 8 * strlen(str);
    return outside ? 0 : dot_of(getchar(str, x / 8), x % 8 - 1, y / 2);
}

#endif
