/* Scenes drawn from a seed: sonars in water and in air of any band, array and range, small enough that hundreds of them
   are measured in minutes. */
#ifndef SASBENCH_SCENE_RANDOM_SCENE_H
#define SASBENCH_SCENE_RANDOM_SCENE_H

#include <stdint.h>
#include <stdio.h>

/* Write a scene file: water, 20 to 300 kHz, or air, 10 to 60 kHz; B/fc .02 to .6; fs/B 1.05 to 4; 5 to 400 m; 1 to
   80 receivers half as long as the transmitter or as long; at most 90 pings, 1500 samples, 40 x 24 pixels, half of
   them on the raster of the pings; raw or compressed echoes of 30 scatterers. Records contain the whole echoes
   within the beam's main lobe. The same seed gives the same text everywhere. */
void random_scene_write(FILE *stream, uint64_t seed);

#endif
