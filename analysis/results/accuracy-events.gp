# Draws accuracy-events.svg and accuracy-events.pdf: gnuplot accuracy-events.gp
set encoding utf8
set terminal svg size 1200,900 noenhanced font 'Helvetica,14' background '#ffffff'
set output 'accuracy-events.svg'
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
set multiplot layout 3,4
set yrange [1e-16:100]
set key off
set title 'bouncing-ball' tc rgb '#333333'
set ylabel 'error, relative'
set xlabel ' '
plot 'accuracy.csv' using (strcol('scene') eq 'bouncing-ball' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'bouncing-ball' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'bouncing-ball' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'bouncing-ball' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'between-walls' tc rgb '#333333'
set ylabel ' '
set xlabel ' '
plot 'accuracy.csv' using (strcol('scene') eq 'between-walls' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'between-walls' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'between-walls' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'between-walls' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'caught-load' tc rgb '#333333'
set ylabel ' '
set xlabel ' '
plot 'accuracy.csv' using (strcol('scene') eq 'caught-load' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'caught-load' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'caught-load' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'caught-load' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'caught-over-a-peg' tc rgb '#333333'
set ylabel ' '
set xlabel ' '
plot 'accuracy.csv' using (strcol('scene') eq 'caught-over-a-peg' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'caught-over-a-peg' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'caught-over-a-peg' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'caught-over-a-peg' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'two-on-slack-cable' tc rgb '#333333'
set ylabel 'error, relative'
set xlabel ' '
plot 'accuracy.csv' using (strcol('scene') eq 'two-on-slack-cable' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'two-on-slack-cable' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'two-on-slack-cable' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'two-on-slack-cable' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'galileos-peg' tc rgb '#333333'
set ylabel ' '
set xlabel ' '
plot 8.02220023583878e-11 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'galileos-peg' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'galileos-peg' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'galileos-peg' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'galileos-peg' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'looping-pendulum' tc rgb '#333333'
set ylabel ' '
set xlabel ' '
plot 6.626449106418133e-11 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'looping-pendulum' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'looping-pendulum' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'looping-pendulum' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'looping-pendulum' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'box-on-a-slope' tc rgb '#333333'
set ylabel ' '
set xlabel 'µs a simulated second'
plot 'accuracy.csv' using (strcol('scene') eq 'box-on-a-slope' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'box-on-a-slope' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'box-on-a-slope' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'box-on-a-slope' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'ball-off-a-table' tc rgb '#333333'
set ylabel 'error, relative'
set xlabel 'µs a simulated second'
plot 'accuracy.csv' using (strcol('scene') eq 'ball-off-a-table' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'ball-off-a-table' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'ball-off-a-table' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'ball-off-a-table' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'box-off-a-table' tc rgb '#333333'
set ylabel ' '
set xlabel 'µs a simulated second'
plot 4.33105099899071e-11 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'box-off-a-table' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'box-off-a-table' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'box-off-a-table' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'box-off-a-table' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'slip-on-a-drum' tc rgb '#333333'
set ylabel ' '
set xlabel 'µs a simulated second'
plot 'accuracy.csv' using (strcol('scene') eq 'slip-on-a-drum' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'slip-on-a-drum' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'slip-on-a-drum' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'slip-on-a-drum' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
unset title
unset xlabel
unset ylabel
unset tics
unset border
unset grid
set key center center invert reverse Left spacing 1.4
set xrange [1:2]
set yrange [1:2]
plot NaN with lines lc rgb '#999999' dt 3 lw 1.5 title "the reference's own doubt", NaN with linespoints ls 2 ps 0.6 title 'events at the steps', NaN with linespoints ls 1 ps 0.6 title 'events at their time'
unset multiplot

reset
set terminal pdfcairo size 12.500,9.375 noenhanced font 'Helvetica,11'
set output 'accuracy-events.pdf'
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
set multiplot layout 3,4
set yrange [1e-16:100]
set key off
set title 'bouncing-ball' tc rgb '#333333'
set ylabel 'error, relative'
set xlabel ' '
plot 'accuracy.csv' using (strcol('scene') eq 'bouncing-ball' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'bouncing-ball' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'bouncing-ball' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'bouncing-ball' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'between-walls' tc rgb '#333333'
set ylabel ' '
set xlabel ' '
plot 'accuracy.csv' using (strcol('scene') eq 'between-walls' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'between-walls' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'between-walls' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'between-walls' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'caught-load' tc rgb '#333333'
set ylabel ' '
set xlabel ' '
plot 'accuracy.csv' using (strcol('scene') eq 'caught-load' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'caught-load' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'caught-load' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'caught-load' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'caught-over-a-peg' tc rgb '#333333'
set ylabel ' '
set xlabel ' '
plot 'accuracy.csv' using (strcol('scene') eq 'caught-over-a-peg' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'caught-over-a-peg' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'caught-over-a-peg' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'caught-over-a-peg' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'two-on-slack-cable' tc rgb '#333333'
set ylabel 'error, relative'
set xlabel ' '
plot 'accuracy.csv' using (strcol('scene') eq 'two-on-slack-cable' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'two-on-slack-cable' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'two-on-slack-cable' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'two-on-slack-cable' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'galileos-peg' tc rgb '#333333'
set ylabel ' '
set xlabel ' '
plot 8.02220023583878e-11 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'galileos-peg' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'galileos-peg' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'galileos-peg' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'galileos-peg' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'looping-pendulum' tc rgb '#333333'
set ylabel ' '
set xlabel ' '
plot 6.626449106418133e-11 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'looping-pendulum' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'looping-pendulum' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'looping-pendulum' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'looping-pendulum' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'box-on-a-slope' tc rgb '#333333'
set ylabel ' '
set xlabel 'µs a simulated second'
plot 'accuracy.csv' using (strcol('scene') eq 'box-on-a-slope' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'box-on-a-slope' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'box-on-a-slope' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'box-on-a-slope' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'ball-off-a-table' tc rgb '#333333'
set ylabel 'error, relative'
set xlabel 'µs a simulated second'
plot 'accuracy.csv' using (strcol('scene') eq 'ball-off-a-table' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'ball-off-a-table' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'ball-off-a-table' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'ball-off-a-table' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'box-off-a-table' tc rgb '#333333'
set ylabel ' '
set xlabel 'µs a simulated second'
plot 4.33105099899071e-11 with lines lc rgb '#999999' dt 3 lw 1.5 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'box-off-a-table' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'box-off-a-table' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'box-off-a-table' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'box-off-a-table' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
set title 'slip-on-a-drum' tc rgb '#333333'
set ylabel ' '
set xlabel 'µs a simulated second'
plot 'accuracy.csv' using (strcol('scene') eq 'slip-on-a-drum' && strcol('setting') eq 'pinch direct with events at the steps' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'slip-on-a-drum' && strcol('setting') eq 'pinch direct with events at the steps' ? column('error') : NaN))) with linespoints ls 2 ps 0.6 notitle, \
  'accuracy.csv' using (strcol('scene') eq 'slip-on-a-drum' && strcol('setting') eq 'pinch direct' ? column('cpu_us_per_s') : NaN):(drawn((strcol('scene') eq 'slip-on-a-drum' && strcol('setting') eq 'pinch direct' ? column('error') : NaN))) with linespoints ls 1 ps 0.6 notitle
unset title
unset xlabel
unset ylabel
unset tics
unset border
unset grid
set key center center invert reverse Left spacing 1.4
set xrange [1:2]
set yrange [1:2]
plot NaN with lines lc rgb '#999999' dt 3 lw 1.5 title "the reference's own doubt", NaN with linespoints ls 2 ps 0.6 title 'events at the steps', NaN with linespoints ls 1 ps 0.6 title 'events at their time'
unset multiplot

set output
