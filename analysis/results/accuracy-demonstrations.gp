# Draws accuracy-demonstrations.svg and accuracy-demonstrations.pdf: gnuplot accuracy-demonstrations.gp
set encoding utf8
set terminal svg size 1100,900 noenhanced font 'Helvetica,14' background '#ffffff'
set output 'accuracy-demonstrations.svg'
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
set multiplot layout 3,3
set yrange [1e-12:10000]
set xrange [10:*]
set key off
set title '01-roll-over' tc rgb '#333333'
set ylabel 'error, relative'
set xlabel ' '
plot 3.389416058639656e-09 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq '01-roll-over' && strcol('setting') eq 'cable iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '01-roll-over' && strcol('setting') eq 'cable iterative' ? column('error') : NaN))) with linespoints ls 6 dt 2 ps 0.5 title 'cable iterative', \
  'accuracy.csv' using (strcol('scene') eq '01-roll-over' && strcol('setting') eq 'cable direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '01-roll-over' && strcol('setting') eq 'cable direct' ? column('error') : NaN))) with linespoints ls 6 dt 1 ps 0.5 title 'cable direct', \
  'accuracy.csv' using (strcol('scene') eq '01-roll-over' && strcol('setting') eq 'pinch_no_contact iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '01-roll-over' && strcol('setting') eq 'pinch_no_contact iterative' ? column('error') : NaN))) with linespoints ls 7 dt 2 ps 0.5 title 'pinch_no_contact iterative', \
  'accuracy.csv' using (strcol('scene') eq '01-roll-over' && strcol('setting') eq 'pinch_no_contact direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '01-roll-over' && strcol('setting') eq 'pinch_no_contact direct' ? column('error') : NaN))) with linespoints ls 7 dt 1 ps 0.5 title 'pinch_no_contact direct', \
  'accuracy.csv' using (strcol('scene') eq '01-roll-over' && strcol('setting') eq 'thesis' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '01-roll-over' && strcol('setting') eq 'thesis' ? column('error') : NaN))) with linespoints ls 3 dt 1 ps 0.5 title 'thesis', \
  'accuracy.csv' using (strcol('scene') eq '01-roll-over' && strcol('setting') eq 'pinch iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '01-roll-over' && strcol('setting') eq 'pinch iterative' ? column('error') : NaN))) with linespoints ls 2 dt 1 ps 0.5 title 'pinch iterative', \
  'accuracy.csv' using (strcol('scene') eq '01-roll-over' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '01-roll-over' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 dt 1 ps 0.5 title 'pinch direct'
set title '02-stack' tc rgb '#333333'
set ylabel ' '
set xlabel ' '
plot 3.905129246580075e-10 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq '02-stack' && strcol('setting') eq 'cable iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '02-stack' && strcol('setting') eq 'cable iterative' ? column('error') : NaN))) with linespoints ls 6 dt 2 ps 0.5 title 'cable iterative', \
  'accuracy.csv' using (strcol('scene') eq '02-stack' && strcol('setting') eq 'cable direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '02-stack' && strcol('setting') eq 'cable direct' ? column('error') : NaN))) with linespoints ls 6 dt 1 ps 0.5 title 'cable direct', \
  'accuracy.csv' using (strcol('scene') eq '02-stack' && strcol('setting') eq 'pinch_no_contact iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '02-stack' && strcol('setting') eq 'pinch_no_contact iterative' ? column('error') : NaN))) with linespoints ls 7 dt 2 ps 0.5 title 'pinch_no_contact iterative', \
  'accuracy.csv' using (strcol('scene') eq '02-stack' && strcol('setting') eq 'pinch_no_contact direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '02-stack' && strcol('setting') eq 'pinch_no_contact direct' ? column('error') : NaN))) with linespoints ls 7 dt 1 ps 0.5 title 'pinch_no_contact direct', \
  'accuracy.csv' using (strcol('scene') eq '02-stack' && strcol('setting') eq 'thesis' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '02-stack' && strcol('setting') eq 'thesis' ? column('error') : NaN))) with linespoints ls 3 dt 1 ps 0.5 title 'thesis', \
  'accuracy.csv' using (strcol('scene') eq '02-stack' && strcol('setting') eq 'pinch iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '02-stack' && strcol('setting') eq 'pinch iterative' ? column('error') : NaN))) with linespoints ls 2 dt 1 ps 0.5 title 'pinch iterative', \
  'accuracy.csv' using (strcol('scene') eq '02-stack' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '02-stack' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 dt 1 ps 0.5 title 'pinch direct'
set title '03-drop' tc rgb '#333333'
set ylabel ' '
set xlabel ' '
plot 1.9809606728355157e-10 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq '03-drop' && strcol('setting') eq 'cable iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '03-drop' && strcol('setting') eq 'cable iterative' ? column('error') : NaN))) with linespoints ls 6 dt 2 ps 0.5 title 'cable iterative', \
  'accuracy.csv' using (strcol('scene') eq '03-drop' && strcol('setting') eq 'cable direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '03-drop' && strcol('setting') eq 'cable direct' ? column('error') : NaN))) with linespoints ls 6 dt 1 ps 0.5 title 'cable direct', \
  'accuracy.csv' using (strcol('scene') eq '03-drop' && strcol('setting') eq 'pinch_no_contact iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '03-drop' && strcol('setting') eq 'pinch_no_contact iterative' ? column('error') : NaN))) with linespoints ls 7 dt 2 ps 0.5 title 'pinch_no_contact iterative', \
  'accuracy.csv' using (strcol('scene') eq '03-drop' && strcol('setting') eq 'pinch_no_contact direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '03-drop' && strcol('setting') eq 'pinch_no_contact direct' ? column('error') : NaN))) with linespoints ls 7 dt 1 ps 0.5 title 'pinch_no_contact direct', \
  'accuracy.csv' using (strcol('scene') eq '03-drop' && strcol('setting') eq 'thesis' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '03-drop' && strcol('setting') eq 'thesis' ? column('error') : NaN))) with linespoints ls 3 dt 1 ps 0.5 title 'thesis', \
  'accuracy.csv' using (strcol('scene') eq '03-drop' && strcol('setting') eq 'pinch iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '03-drop' && strcol('setting') eq 'pinch iterative' ? column('error') : NaN))) with linespoints ls 2 dt 1 ps 0.5 title 'pinch iterative', \
  'accuracy.csv' using (strcol('scene') eq '03-drop' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '03-drop' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 dt 1 ps 0.5 title 'pinch direct'
set title '04-two-blocking' tc rgb '#333333'
set ylabel 'error, relative'
set xlabel ' '
plot 2.6148151979198225e-07 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'cable iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'cable iterative' ? column('error') : NaN))) with linespoints ls 6 dt 2 ps 0.5 title 'cable iterative', \
  'accuracy.csv' using (strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'cable direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'cable direct' ? column('error') : NaN))) with linespoints ls 6 dt 1 ps 0.5 title 'cable direct', \
  'accuracy.csv' using (strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'pinch_no_contact iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'pinch_no_contact iterative' ? column('error') : NaN))) with linespoints ls 7 dt 2 ps 0.5 title 'pinch_no_contact iterative', \
  'accuracy.csv' using (strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'pinch_no_contact direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'pinch_no_contact direct' ? column('error') : NaN))) with linespoints ls 7 dt 1 ps 0.5 title 'pinch_no_contact direct', \
  'accuracy.csv' using (strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'thesis' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'thesis' ? column('error') : NaN))) with linespoints ls 3 dt 1 ps 0.5 title 'thesis', \
  'accuracy.csv' using (strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'pinch iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'pinch iterative' ? column('error') : NaN))) with linespoints ls 2 dt 1 ps 0.5 title 'pinch iterative', \
  'accuracy.csv' using (strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 dt 1 ps 0.5 title 'pinch direct'
set title '05-notch' tc rgb '#333333'
set ylabel ' '
set xlabel ' '
plot 4.561159868993041e-06 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq '05-notch' && strcol('setting') eq 'cable iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '05-notch' && strcol('setting') eq 'cable iterative' ? column('error') : NaN))) with linespoints ls 6 dt 2 ps 0.5 title 'cable iterative', \
  'accuracy.csv' using (strcol('scene') eq '05-notch' && strcol('setting') eq 'cable direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '05-notch' && strcol('setting') eq 'cable direct' ? column('error') : NaN))) with linespoints ls 6 dt 1 ps 0.5 title 'cable direct', \
  'accuracy.csv' using (strcol('scene') eq '05-notch' && strcol('setting') eq 'pinch_no_contact iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '05-notch' && strcol('setting') eq 'pinch_no_contact iterative' ? column('error') : NaN))) with linespoints ls 7 dt 2 ps 0.5 title 'pinch_no_contact iterative', \
  'accuracy.csv' using (strcol('scene') eq '05-notch' && strcol('setting') eq 'pinch_no_contact direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '05-notch' && strcol('setting') eq 'pinch_no_contact direct' ? column('error') : NaN))) with linespoints ls 7 dt 1 ps 0.5 title 'pinch_no_contact direct', \
  'accuracy.csv' using (strcol('scene') eq '05-notch' && strcol('setting') eq 'thesis' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '05-notch' && strcol('setting') eq 'thesis' ? column('error') : NaN))) with linespoints ls 3 dt 1 ps 0.5 title 'thesis', \
  'accuracy.csv' using (strcol('scene') eq '05-notch' && strcol('setting') eq 'pinch iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '05-notch' && strcol('setting') eq 'pinch iterative' ? column('error') : NaN))) with linespoints ls 2 dt 1 ps 0.5 title 'pinch iterative', \
  'accuracy.csv' using (strcol('scene') eq '05-notch' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '05-notch' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 dt 1 ps 0.5 title 'pinch direct'
set title '06-windlass' tc rgb '#333333'
set ylabel ' '
set xlabel 'µs a simulated second'
plot 8.070347720116964e-11 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq '06-windlass' && strcol('setting') eq 'cable iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '06-windlass' && strcol('setting') eq 'cable iterative' ? column('error') : NaN))) with linespoints ls 6 dt 2 ps 0.5 title 'cable iterative', \
  'accuracy.csv' using (strcol('scene') eq '06-windlass' && strcol('setting') eq 'cable direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '06-windlass' && strcol('setting') eq 'cable direct' ? column('error') : NaN))) with linespoints ls 6 dt 1 ps 0.5 title 'cable direct', \
  'accuracy.csv' using (strcol('scene') eq '06-windlass' && strcol('setting') eq 'pinch_no_contact iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '06-windlass' && strcol('setting') eq 'pinch_no_contact iterative' ? column('error') : NaN))) with linespoints ls 7 dt 2 ps 0.5 title 'pinch_no_contact iterative', \
  'accuracy.csv' using (strcol('scene') eq '06-windlass' && strcol('setting') eq 'pinch_no_contact direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '06-windlass' && strcol('setting') eq 'pinch_no_contact direct' ? column('error') : NaN))) with linespoints ls 7 dt 1 ps 0.5 title 'pinch_no_contact direct', \
  'accuracy.csv' using (strcol('scene') eq '06-windlass' && strcol('setting') eq 'thesis' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '06-windlass' && strcol('setting') eq 'thesis' ? column('error') : NaN))) with linespoints ls 3 dt 1 ps 0.5 title 'thesis', \
  'accuracy.csv' using (strcol('scene') eq '06-windlass' && strcol('setting') eq 'pinch iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '06-windlass' && strcol('setting') eq 'pinch iterative' ? column('error') : NaN))) with linespoints ls 2 dt 1 ps 0.5 title 'pinch iterative', \
  'accuracy.csv' using (strcol('scene') eq '06-windlass' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '06-windlass' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 dt 1 ps 0.5 title 'pinch direct'
set title '07-driven-roller' tc rgb '#333333'
set ylabel 'error, relative'
set xlabel 'µs a simulated second'
plot 7.8151770769237e-12 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'cable iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'cable iterative' ? column('error') : NaN))) with linespoints ls 6 dt 2 ps 0.5 title 'cable iterative', \
  'accuracy.csv' using (strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'cable direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'cable direct' ? column('error') : NaN))) with linespoints ls 6 dt 1 ps 0.5 title 'cable direct', \
  'accuracy.csv' using (strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'pinch_no_contact iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'pinch_no_contact iterative' ? column('error') : NaN))) with linespoints ls 7 dt 2 ps 0.5 title 'pinch_no_contact iterative', \
  'accuracy.csv' using (strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'pinch_no_contact direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'pinch_no_contact direct' ? column('error') : NaN))) with linespoints ls 7 dt 1 ps 0.5 title 'pinch_no_contact direct', \
  'accuracy.csv' using (strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'thesis' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'thesis' ? column('error') : NaN))) with linespoints ls 3 dt 1 ps 0.5 title 'thesis', \
  'accuracy.csv' using (strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'pinch iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'pinch iterative' ? column('error') : NaN))) with linespoints ls 2 dt 1 ps 0.5 title 'pinch iterative', \
  'accuracy.csv' using (strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 dt 1 ps 0.5 title 'pinch direct'
set title '08-driven-roller-weights' tc rgb '#333333'
set ylabel ' '
set xlabel 'µs a simulated second'
plot 9.474725155821059e-12 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'cable iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'cable iterative' ? column('error') : NaN))) with linespoints ls 6 dt 2 ps 0.5 title 'cable iterative', \
  'accuracy.csv' using (strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'cable direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'cable direct' ? column('error') : NaN))) with linespoints ls 6 dt 1 ps 0.5 title 'cable direct', \
  'accuracy.csv' using (strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'pinch_no_contact iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'pinch_no_contact iterative' ? column('error') : NaN))) with linespoints ls 7 dt 2 ps 0.5 title 'pinch_no_contact iterative', \
  'accuracy.csv' using (strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'pinch_no_contact direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'pinch_no_contact direct' ? column('error') : NaN))) with linespoints ls 7 dt 1 ps 0.5 title 'pinch_no_contact direct', \
  'accuracy.csv' using (strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'thesis' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'thesis' ? column('error') : NaN))) with linespoints ls 3 dt 1 ps 0.5 title 'thesis', \
  'accuracy.csv' using (strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'pinch iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'pinch iterative' ? column('error') : NaN))) with linespoints ls 2 dt 1 ps 0.5 title 'pinch iterative', \
  'accuracy.csv' using (strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 dt 1 ps 0.5 title 'pinch direct'
unset title
unset xlabel
unset ylabel
unset tics
unset border
unset grid
set key center center invert reverse Left spacing 1.4
set xrange [1:2]
set yrange [1:2]
plot NaN with linespoints ls 6 dt 2 title 'cable iterative', NaN with linespoints ls 6 dt 1 title 'cable direct', NaN with linespoints ls 7 dt 2 title 'pinch_no_contact iterative', NaN with linespoints ls 7 dt 1 title 'pinch_no_contact direct', NaN with linespoints ls 3 dt 1 title 'thesis', NaN with linespoints ls 2 dt 1 title 'pinch iterative', NaN with linespoints ls 1 dt 1 title 'pinch direct', NaN with lines lc rgb '#999999' dt 3 lw 1.5 title "the reference's own doubt"
unset multiplot

reset
set terminal pdfcairo size 11.458,9.375 noenhanced font 'Helvetica,11'
set output 'accuracy-demonstrations.pdf'
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
set multiplot layout 3,3
set yrange [1e-12:10000]
set xrange [10:*]
set key off
set title '01-roll-over' tc rgb '#333333'
set ylabel 'error, relative'
set xlabel ' '
plot 3.389416058639656e-09 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq '01-roll-over' && strcol('setting') eq 'cable iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '01-roll-over' && strcol('setting') eq 'cable iterative' ? column('error') : NaN))) with linespoints ls 6 dt 2 ps 0.5 title 'cable iterative', \
  'accuracy.csv' using (strcol('scene') eq '01-roll-over' && strcol('setting') eq 'cable direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '01-roll-over' && strcol('setting') eq 'cable direct' ? column('error') : NaN))) with linespoints ls 6 dt 1 ps 0.5 title 'cable direct', \
  'accuracy.csv' using (strcol('scene') eq '01-roll-over' && strcol('setting') eq 'pinch_no_contact iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '01-roll-over' && strcol('setting') eq 'pinch_no_contact iterative' ? column('error') : NaN))) with linespoints ls 7 dt 2 ps 0.5 title 'pinch_no_contact iterative', \
  'accuracy.csv' using (strcol('scene') eq '01-roll-over' && strcol('setting') eq 'pinch_no_contact direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '01-roll-over' && strcol('setting') eq 'pinch_no_contact direct' ? column('error') : NaN))) with linespoints ls 7 dt 1 ps 0.5 title 'pinch_no_contact direct', \
  'accuracy.csv' using (strcol('scene') eq '01-roll-over' && strcol('setting') eq 'thesis' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '01-roll-over' && strcol('setting') eq 'thesis' ? column('error') : NaN))) with linespoints ls 3 dt 1 ps 0.5 title 'thesis', \
  'accuracy.csv' using (strcol('scene') eq '01-roll-over' && strcol('setting') eq 'pinch iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '01-roll-over' && strcol('setting') eq 'pinch iterative' ? column('error') : NaN))) with linespoints ls 2 dt 1 ps 0.5 title 'pinch iterative', \
  'accuracy.csv' using (strcol('scene') eq '01-roll-over' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '01-roll-over' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 dt 1 ps 0.5 title 'pinch direct'
set title '02-stack' tc rgb '#333333'
set ylabel ' '
set xlabel ' '
plot 3.905129246580075e-10 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq '02-stack' && strcol('setting') eq 'cable iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '02-stack' && strcol('setting') eq 'cable iterative' ? column('error') : NaN))) with linespoints ls 6 dt 2 ps 0.5 title 'cable iterative', \
  'accuracy.csv' using (strcol('scene') eq '02-stack' && strcol('setting') eq 'cable direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '02-stack' && strcol('setting') eq 'cable direct' ? column('error') : NaN))) with linespoints ls 6 dt 1 ps 0.5 title 'cable direct', \
  'accuracy.csv' using (strcol('scene') eq '02-stack' && strcol('setting') eq 'pinch_no_contact iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '02-stack' && strcol('setting') eq 'pinch_no_contact iterative' ? column('error') : NaN))) with linespoints ls 7 dt 2 ps 0.5 title 'pinch_no_contact iterative', \
  'accuracy.csv' using (strcol('scene') eq '02-stack' && strcol('setting') eq 'pinch_no_contact direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '02-stack' && strcol('setting') eq 'pinch_no_contact direct' ? column('error') : NaN))) with linespoints ls 7 dt 1 ps 0.5 title 'pinch_no_contact direct', \
  'accuracy.csv' using (strcol('scene') eq '02-stack' && strcol('setting') eq 'thesis' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '02-stack' && strcol('setting') eq 'thesis' ? column('error') : NaN))) with linespoints ls 3 dt 1 ps 0.5 title 'thesis', \
  'accuracy.csv' using (strcol('scene') eq '02-stack' && strcol('setting') eq 'pinch iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '02-stack' && strcol('setting') eq 'pinch iterative' ? column('error') : NaN))) with linespoints ls 2 dt 1 ps 0.5 title 'pinch iterative', \
  'accuracy.csv' using (strcol('scene') eq '02-stack' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '02-stack' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 dt 1 ps 0.5 title 'pinch direct'
set title '03-drop' tc rgb '#333333'
set ylabel ' '
set xlabel ' '
plot 1.9809606728355157e-10 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq '03-drop' && strcol('setting') eq 'cable iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '03-drop' && strcol('setting') eq 'cable iterative' ? column('error') : NaN))) with linespoints ls 6 dt 2 ps 0.5 title 'cable iterative', \
  'accuracy.csv' using (strcol('scene') eq '03-drop' && strcol('setting') eq 'cable direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '03-drop' && strcol('setting') eq 'cable direct' ? column('error') : NaN))) with linespoints ls 6 dt 1 ps 0.5 title 'cable direct', \
  'accuracy.csv' using (strcol('scene') eq '03-drop' && strcol('setting') eq 'pinch_no_contact iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '03-drop' && strcol('setting') eq 'pinch_no_contact iterative' ? column('error') : NaN))) with linespoints ls 7 dt 2 ps 0.5 title 'pinch_no_contact iterative', \
  'accuracy.csv' using (strcol('scene') eq '03-drop' && strcol('setting') eq 'pinch_no_contact direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '03-drop' && strcol('setting') eq 'pinch_no_contact direct' ? column('error') : NaN))) with linespoints ls 7 dt 1 ps 0.5 title 'pinch_no_contact direct', \
  'accuracy.csv' using (strcol('scene') eq '03-drop' && strcol('setting') eq 'thesis' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '03-drop' && strcol('setting') eq 'thesis' ? column('error') : NaN))) with linespoints ls 3 dt 1 ps 0.5 title 'thesis', \
  'accuracy.csv' using (strcol('scene') eq '03-drop' && strcol('setting') eq 'pinch iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '03-drop' && strcol('setting') eq 'pinch iterative' ? column('error') : NaN))) with linespoints ls 2 dt 1 ps 0.5 title 'pinch iterative', \
  'accuracy.csv' using (strcol('scene') eq '03-drop' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '03-drop' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 dt 1 ps 0.5 title 'pinch direct'
set title '04-two-blocking' tc rgb '#333333'
set ylabel 'error, relative'
set xlabel ' '
plot 2.6148151979198225e-07 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'cable iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'cable iterative' ? column('error') : NaN))) with linespoints ls 6 dt 2 ps 0.5 title 'cable iterative', \
  'accuracy.csv' using (strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'cable direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'cable direct' ? column('error') : NaN))) with linespoints ls 6 dt 1 ps 0.5 title 'cable direct', \
  'accuracy.csv' using (strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'pinch_no_contact iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'pinch_no_contact iterative' ? column('error') : NaN))) with linespoints ls 7 dt 2 ps 0.5 title 'pinch_no_contact iterative', \
  'accuracy.csv' using (strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'pinch_no_contact direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'pinch_no_contact direct' ? column('error') : NaN))) with linespoints ls 7 dt 1 ps 0.5 title 'pinch_no_contact direct', \
  'accuracy.csv' using (strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'thesis' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'thesis' ? column('error') : NaN))) with linespoints ls 3 dt 1 ps 0.5 title 'thesis', \
  'accuracy.csv' using (strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'pinch iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'pinch iterative' ? column('error') : NaN))) with linespoints ls 2 dt 1 ps 0.5 title 'pinch iterative', \
  'accuracy.csv' using (strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '04-two-blocking' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 dt 1 ps 0.5 title 'pinch direct'
set title '05-notch' tc rgb '#333333'
set ylabel ' '
set xlabel ' '
plot 4.561159868993041e-06 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq '05-notch' && strcol('setting') eq 'cable iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '05-notch' && strcol('setting') eq 'cable iterative' ? column('error') : NaN))) with linespoints ls 6 dt 2 ps 0.5 title 'cable iterative', \
  'accuracy.csv' using (strcol('scene') eq '05-notch' && strcol('setting') eq 'cable direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '05-notch' && strcol('setting') eq 'cable direct' ? column('error') : NaN))) with linespoints ls 6 dt 1 ps 0.5 title 'cable direct', \
  'accuracy.csv' using (strcol('scene') eq '05-notch' && strcol('setting') eq 'pinch_no_contact iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '05-notch' && strcol('setting') eq 'pinch_no_contact iterative' ? column('error') : NaN))) with linespoints ls 7 dt 2 ps 0.5 title 'pinch_no_contact iterative', \
  'accuracy.csv' using (strcol('scene') eq '05-notch' && strcol('setting') eq 'pinch_no_contact direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '05-notch' && strcol('setting') eq 'pinch_no_contact direct' ? column('error') : NaN))) with linespoints ls 7 dt 1 ps 0.5 title 'pinch_no_contact direct', \
  'accuracy.csv' using (strcol('scene') eq '05-notch' && strcol('setting') eq 'thesis' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '05-notch' && strcol('setting') eq 'thesis' ? column('error') : NaN))) with linespoints ls 3 dt 1 ps 0.5 title 'thesis', \
  'accuracy.csv' using (strcol('scene') eq '05-notch' && strcol('setting') eq 'pinch iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '05-notch' && strcol('setting') eq 'pinch iterative' ? column('error') : NaN))) with linespoints ls 2 dt 1 ps 0.5 title 'pinch iterative', \
  'accuracy.csv' using (strcol('scene') eq '05-notch' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '05-notch' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 dt 1 ps 0.5 title 'pinch direct'
set title '06-windlass' tc rgb '#333333'
set ylabel ' '
set xlabel 'µs a simulated second'
plot 8.070347720116964e-11 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq '06-windlass' && strcol('setting') eq 'cable iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '06-windlass' && strcol('setting') eq 'cable iterative' ? column('error') : NaN))) with linespoints ls 6 dt 2 ps 0.5 title 'cable iterative', \
  'accuracy.csv' using (strcol('scene') eq '06-windlass' && strcol('setting') eq 'cable direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '06-windlass' && strcol('setting') eq 'cable direct' ? column('error') : NaN))) with linespoints ls 6 dt 1 ps 0.5 title 'cable direct', \
  'accuracy.csv' using (strcol('scene') eq '06-windlass' && strcol('setting') eq 'pinch_no_contact iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '06-windlass' && strcol('setting') eq 'pinch_no_contact iterative' ? column('error') : NaN))) with linespoints ls 7 dt 2 ps 0.5 title 'pinch_no_contact iterative', \
  'accuracy.csv' using (strcol('scene') eq '06-windlass' && strcol('setting') eq 'pinch_no_contact direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '06-windlass' && strcol('setting') eq 'pinch_no_contact direct' ? column('error') : NaN))) with linespoints ls 7 dt 1 ps 0.5 title 'pinch_no_contact direct', \
  'accuracy.csv' using (strcol('scene') eq '06-windlass' && strcol('setting') eq 'thesis' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '06-windlass' && strcol('setting') eq 'thesis' ? column('error') : NaN))) with linespoints ls 3 dt 1 ps 0.5 title 'thesis', \
  'accuracy.csv' using (strcol('scene') eq '06-windlass' && strcol('setting') eq 'pinch iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '06-windlass' && strcol('setting') eq 'pinch iterative' ? column('error') : NaN))) with linespoints ls 2 dt 1 ps 0.5 title 'pinch iterative', \
  'accuracy.csv' using (strcol('scene') eq '06-windlass' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '06-windlass' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 dt 1 ps 0.5 title 'pinch direct'
set title '07-driven-roller' tc rgb '#333333'
set ylabel 'error, relative'
set xlabel 'µs a simulated second'
plot 7.8151770769237e-12 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'cable iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'cable iterative' ? column('error') : NaN))) with linespoints ls 6 dt 2 ps 0.5 title 'cable iterative', \
  'accuracy.csv' using (strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'cable direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'cable direct' ? column('error') : NaN))) with linespoints ls 6 dt 1 ps 0.5 title 'cable direct', \
  'accuracy.csv' using (strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'pinch_no_contact iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'pinch_no_contact iterative' ? column('error') : NaN))) with linespoints ls 7 dt 2 ps 0.5 title 'pinch_no_contact iterative', \
  'accuracy.csv' using (strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'pinch_no_contact direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'pinch_no_contact direct' ? column('error') : NaN))) with linespoints ls 7 dt 1 ps 0.5 title 'pinch_no_contact direct', \
  'accuracy.csv' using (strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'thesis' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'thesis' ? column('error') : NaN))) with linespoints ls 3 dt 1 ps 0.5 title 'thesis', \
  'accuracy.csv' using (strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'pinch iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'pinch iterative' ? column('error') : NaN))) with linespoints ls 2 dt 1 ps 0.5 title 'pinch iterative', \
  'accuracy.csv' using (strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '07-driven-roller' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 dt 1 ps 0.5 title 'pinch direct'
set title '08-driven-roller-weights' tc rgb '#333333'
set ylabel ' '
set xlabel 'µs a simulated second'
plot 9.474725155821059e-12 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'cable iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'cable iterative' ? column('error') : NaN))) with linespoints ls 6 dt 2 ps 0.5 title 'cable iterative', \
  'accuracy.csv' using (strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'cable direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'cable direct' ? column('error') : NaN))) with linespoints ls 6 dt 1 ps 0.5 title 'cable direct', \
  'accuracy.csv' using (strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'pinch_no_contact iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'pinch_no_contact iterative' ? column('error') : NaN))) with linespoints ls 7 dt 2 ps 0.5 title 'pinch_no_contact iterative', \
  'accuracy.csv' using (strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'pinch_no_contact direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'pinch_no_contact direct' ? column('error') : NaN))) with linespoints ls 7 dt 1 ps 0.5 title 'pinch_no_contact direct', \
  'accuracy.csv' using (strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'thesis' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'thesis' ? column('error') : NaN))) with linespoints ls 3 dt 1 ps 0.5 title 'thesis', \
  'accuracy.csv' using (strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'pinch iterative' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'pinch iterative' ? column('error') : NaN))) with linespoints ls 2 dt 1 ps 0.5 title 'pinch iterative', \
  'accuracy.csv' using (strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq '08-driven-roller-weights' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 dt 1 ps 0.5 title 'pinch direct'
unset title
unset xlabel
unset ylabel
unset tics
unset border
unset grid
set key center center invert reverse Left spacing 1.4
set xrange [1:2]
set yrange [1:2]
plot NaN with linespoints ls 6 dt 2 title 'cable iterative', NaN with linespoints ls 6 dt 1 title 'cable direct', NaN with linespoints ls 7 dt 2 title 'pinch_no_contact iterative', NaN with linespoints ls 7 dt 1 title 'pinch_no_contact direct', NaN with linespoints ls 3 dt 1 title 'thesis', NaN with linespoints ls 2 dt 1 title 'pinch iterative', NaN with linespoints ls 1 dt 1 title 'pinch direct', NaN with lines lc rgb '#999999' dt 3 lw 1.5 title "the reference's own doubt"
unset multiplot

set output
