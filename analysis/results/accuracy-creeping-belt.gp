# Draws accuracy-creeping-belt.svg and accuracy-creeping-belt.pdf: gnuplot accuracy-creeping-belt.gp
set encoding utf8
set terminal svg size 900,480 noenhanced font 'Helvetica,14' background '#ffffff'
set output 'accuracy-creeping-belt.svg'
set datafile separator comma
set datafile commentschars '#'
set datafile columnheaders
set datafile missing NaN
set grid lc rgb '#e0e0e0' lt 1
set border 3 lc rgb '#888888'
set tics nomirror scale 0.5 tc rgb '#333333'
set style line 1 lc rgb '#0072B2' lw 2 pt 7 ps 0.7
set style line 2 lc rgb '#D55E00' lw 2 pt 5 ps 0.7
set style line 3 lc rgb '#009E73' lw 2 pt 9 ps 0.8
set style line 4 lc rgb '#CC79A7' lw 2 pt 11 ps 0.8
set style line 5 lc rgb '#E69F00' lw 2 pt 13 ps 0.8
set style line 6 lc rgb '#56B4E9' lw 2 pt 6 ps 0.8
set style line 7 lc rgb '#555555' lw 2 pt 4 ps 0.8
set style line 8 lc rgb '#000000' lw 2 pt 8 ps 0.8
drawn(e) = e < 1e-16 ? 1e-16 : e
set logscale xy
set format x '1e%T'
set format y '1e%T'
set mxtics 10
set mytics 1
set title 'A belt creeps over its pulleys' tc rgb '#333333'
set xlabel 'processor time a simulated second (µs)'
set ylabel 'error / the farthest that a centre or rim gets from its start'
set yrange [1e-08:0.1]
set key outside right center invert reverse Left spacing 1.3
plot 1.3355844851206353e-09 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'cable iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'cable iterative' ? column('error') : NaN))) with linespoints ls 6 dt 2 ps 0.7 title 'cable iterative', \
  'accuracy.csv' using (strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'cable direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'cable direct' ? column('error') : NaN))) with linespoints ls 6 dt 1 ps 0.7 title 'cable direct', \
  'accuracy.csv' using (strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'pinch_no_contact iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'pinch_no_contact iterative' ? column('error') : NaN))) with linespoints ls 7 dt 2 ps 0.7 title 'pinch_no_contact iterative', \
  'accuracy.csv' using (strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'pinch_no_contact direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'pinch_no_contact direct' ? column('error') : NaN))) with linespoints ls 7 dt 1 ps 0.7 title 'pinch_no_contact direct', \
  'accuracy.csv' using (strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'thesis' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'thesis' ? column('error') : NaN))) with linespoints ls 3 dt 1 ps 0.7 title 'thesis', \
  'accuracy.csv' using (strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'pinch iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'pinch iterative' ? column('error') : NaN))) with linespoints ls 2 dt 1 ps 0.7 title 'pinch iterative', \
  'accuracy.csv' using (strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 dt 1 ps 0.7 title 'pinch direct'

reset
set terminal pdfcairo size 9.375,5.000 noenhanced font 'Helvetica,11'
set output 'accuracy-creeping-belt.pdf'
set datafile separator comma
set datafile commentschars '#'
set datafile columnheaders
set datafile missing NaN
set grid lc rgb '#e0e0e0' lt 1
set border 3 lc rgb '#888888'
set tics nomirror scale 0.5 tc rgb '#333333'
set style line 1 lc rgb '#0072B2' lw 2 pt 7 ps 0.7
set style line 2 lc rgb '#D55E00' lw 2 pt 5 ps 0.7
set style line 3 lc rgb '#009E73' lw 2 pt 9 ps 0.8
set style line 4 lc rgb '#CC79A7' lw 2 pt 11 ps 0.8
set style line 5 lc rgb '#E69F00' lw 2 pt 13 ps 0.8
set style line 6 lc rgb '#56B4E9' lw 2 pt 6 ps 0.8
set style line 7 lc rgb '#555555' lw 2 pt 4 ps 0.8
set style line 8 lc rgb '#000000' lw 2 pt 8 ps 0.8
drawn(e) = e < 1e-16 ? 1e-16 : e
set logscale xy
set format x '1e%T'
set format y '1e%T'
set mxtics 10
set mytics 1
set title 'A belt creeps over its pulleys' tc rgb '#333333'
set xlabel 'processor time a simulated second (µs)'
set ylabel 'error / the farthest that a centre or rim gets from its start'
set yrange [1e-08:0.1]
set key outside right center invert reverse Left spacing 1.3
plot 1.3355844851206353e-09 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'cable iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'cable iterative' ? column('error') : NaN))) with linespoints ls 6 dt 2 ps 0.7 title 'cable iterative', \
  'accuracy.csv' using (strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'cable direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'cable direct' ? column('error') : NaN))) with linespoints ls 6 dt 1 ps 0.7 title 'cable direct', \
  'accuracy.csv' using (strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'pinch_no_contact iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'pinch_no_contact iterative' ? column('error') : NaN))) with linespoints ls 7 dt 2 ps 0.7 title 'pinch_no_contact iterative', \
  'accuracy.csv' using (strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'pinch_no_contact direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'pinch_no_contact direct' ? column('error') : NaN))) with linespoints ls 7 dt 1 ps 0.7 title 'pinch_no_contact direct', \
  'accuracy.csv' using (strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'thesis' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'thesis' ? column('error') : NaN))) with linespoints ls 3 dt 1 ps 0.7 title 'thesis', \
  'accuracy.csv' using (strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'pinch iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'pinch iterative' ? column('error') : NaN))) with linespoints ls 2 dt 1 ps 0.7 title 'pinch iterative', \
  'accuracy.csv' using (strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'creeping-belt' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 dt 1 ps 0.7 title 'pinch direct'

set output
